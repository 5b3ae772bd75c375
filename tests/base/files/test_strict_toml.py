"""On which line of a TOML file a key stands."""

import tomllib
from dataclasses import dataclass
from typing import Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.base.files.strict_toml import TomlDocument

TEXT = """\
# max = 1 and [gpu] in a comment
schema = "a # b" # max = 2
note = \"\"\"
max = 3
[gpu]
\"\"\"
[gpu.linear]
rows = [
  [1.0, 2.0],  # max = 4
  [3.0, 4.0],
]
max = 5
"quoted key" = '[disk]'
inline = { min = 1, max = 2 }

[[for]]
policy = "a"

[[for]]
max = 6
  [for.limits]
  max = 7
[deep.er]
dotted.key = 8
"""


@pytest.mark.parametrize(
    ("where", "line"),
    [
        ("schema", 2),
        ("note", 3),
        ("gpu", 7),
        ("gpu.linear", 7),
        ("gpu.linear.rows", 8),
        ("gpu.linear.max", 12),
        ("gpu.linear.quoted key", 13),
        ("gpu.linear.inline.max", 14),
        ("for", 16),
        ("for.0.policy", 17),
        ("for.0.max", 16),
        ("for.1", 19),
        ("for.1.max", 20),
        ("for.1.limits", 21),
        ("for.1.limits.max", 22),
        ("deep", 23),
        ("deep.er.dotted", 24),
        ("deep.er.dotted.key", 24),
        ("gpu.base", 7),
        ("max", None),
        ("", None),
    ],
)
def test_the_line_of_a_key(where: str, line: int | None) -> None:
    """Comments, strings and rows of numbers are no keys; what is missing is at its table."""
    assert tomllib.loads(TEXT)["for"][1]["limits"] == {"max": 7}
    assert TomlDocument(TEXT).line_of(where) == line


names = st.text("ab-_1", min_size=1, max_size=3)
values = st.sampled_from(
    ["1", '"#"', "[ # a = 1\n 1,\n]", '"""\nb = 2\n"""', "''''a''''", "{a = 1}"]
)


@given(st.lists(st.tuples(names, values), unique_by=lambda item: item[0], max_size=6))
def test_every_key_has_the_line_on_which_it_was_written(items: list[tuple[str, str]]) -> None:
    """Whatever values stand between them."""
    text, lines = "# a = 1\n", dict[str, int]()
    for name, value in items:
        lines[name] = text.count("\n") + 1
        text += f"{name} = {value} # {name} = 1\n"
    document = TomlDocument(text)
    assert list(document.content) == list(lines)
    assert {name: document.line_of(name) for name in lines} == lines


@dataclass(frozen=True, slots=True)
class Amount:
    """A record as readers have them."""

    value: float
    unit: Literal["ns", "ms"] = "ns"


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("a = 1\n[b]\nvalu = 1", 3, "expected one of value, unit, got valu; did you mean value?"),
        ("a = 1\n[b]\nvalue = 'x'", 3, "b.value: expected float, got str"),
        ("\n[b]\nvalue = 1\nunit = 'm'", 4, "expected one of ns, ms, got m; did you mean ms?"),
        ("\n[b]\nunit = 'ms'", 2, "expected the key value, found none; add it"),
        ("\nb = 1", 2, "expected a table, got int"),
        ("\n[[b]]\nvalue = 1", 2, "expected a table, got list"),
        ("\n[b", 2, "expected TOML"),
        ("a = [1,\n", 2, "expected TOML"),
        ("a = " + "[" * 100_000, None, "nested too deep"),
    ],
)
def test_a_table_that_is_no_such_record(text: str, line: int | None, message: str) -> None:
    """Each mistake has the line of what is wrong."""
    document = TomlDocument(text)
    with pytest.raises(InputError) as caught:
        document.record(document.content["b"], Amount, "b")
    assert message in caught.value.message
    assert caught.value.line == line


def test_tables_of_an_array_are_counted() -> None:
    """The label of a place shows which table of several is meant."""
    with pytest.raises(InputError, match=r"^\d+: for\[1\].limits.max: too much"):
        TomlDocument(TEXT).fail("for.1.limits.max", "too much")
