"""`lodbench list`: names that can be used, with what a user has to know about each."""

import json
from typing import Any, get_args

import pytest

from lodbench.analysis.study.inputs import load_trace
from lodbench.cli.list import Subject, known
from lodbench.cli.main import run
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.models.scenes.scene_registry import find_builder
from lodbench.policies.registry import REGISTERED, parse_policy
from lodbench.traces.cameras.read_trace import FORMATS
from lodbench.traces.logs.read_log import LOG_FORMATS


def listed(kind: str, capsys: pytest.CaptureFixture[str]) -> list[dict[str, Any]]:
    """Return the items of the JSON document that the command prints."""
    assert run(["list", kind, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "lodbench.list/1"
    assert document["kind"] == kind
    return document["items"]


@pytest.mark.parametrize("kind", get_args(Subject))
def test_json_and_table_show_the_same_names(
    kind: Subject, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every item of the JSON document stands in the table, and has the same keys as the others."""
    items = listed(kind, capsys)
    assert len({tuple(item) for item in items}) == 1
    monkeypatch.setenv("COLUMNS", "200")
    assert run(["list", kind]) == 0
    table = capsys.readouterr().out
    assert all(str(next(iter(item.values()))) in table for item in items)


def test_listed_names_can_be_used(capsys: pytest.CaptureFixture[str]) -> None:
    """What is listed is accepted where a name is asked for."""
    for item in listed("hardware", capsys):
        assert load_hardware(item["name"]).provenance.assumed == item["assumed"]
    for item in listed("scenes", capsys):
        assert find_builder(item["name"]) is not None
    scene = load_scene("plaza")
    for item in listed("traces", capsys):
        assert load_trace(item["name"], scene).name.startswith(item["name"])
    assert {item["name"] for item in listed("policies", capsys)} == set(REGISTERED)
    for item in listed("formats", capsys):
        formats = FORMATS if item["of"] == "camera traces" else LOG_FORMATS
        assert formats.find(item["name"]).what == item["about"]


def test_policies_show_parameters_with_defaults(capsys: pytest.CaptureFixture[str]) -> None:
    """Each parameter has the default of the class, is accepted, and is explained by a comment."""
    for item in listed("policies", capsys):
        made = parse_policy(item["name"]).make()
        for parameter in item["parameters"]:
            assert getattr(made, parameter["name"]) == parameter["default"]
            assert parameter["comment"]


def test_policies_say_where_they_come_from(capsys: pytest.CaptureFixture[str]) -> None:
    """Idea, needs, cost and reference of every policy are filled in."""
    for item in listed("policies", capsys):
        assert all(item[key] for key in ("idea", "uses", "cost_per_frame", "reference"))
        assert item["capabilities"]


def test_feedback_as_listed() -> None:
    """One policy by hand: its gain, and that it sees no future."""
    (feedback,) = (item for item in known("policies") if item["name"] == "feedback")
    gain = {"name": "gain", "default": 0.5, "comment": "Unreal's square root"}
    assert gain in feedback["parameters"]
    assert feedback["oracle"] is False
    assert feedback["claims"] == []
    assert "levels" in feedback["capabilities"]


def test_claims_as_listed() -> None:
    """Claims of three policies with their defaults: properties that hold, and when they rest."""
    claims = {item["name"]: item["claims"] for item in known("policies")}
    assert claims["wimmer"] == ["budget", "monotone", "rests at once"]
    assert claims["mason-blake"] == ["budget", "rests after 1 frame"]
    assert claims["maciel"] == ["budget", "rests after 10 frames"]


def test_knobs_as_listed(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One knob by hand in both forms; a policy has a knob or says why it has none."""
    items = {item["name"]: item for item in listed("policies", capsys)}
    ends = {"low": 0.005, "high": 50.0}
    bias = {"name": "bias", **ends, "scale": "log", "finer": "higher"}
    assert items["static-screen"]["knob"] == bias
    assert items["full"]["knob"] is None
    assert all((item["knob"] is None) == bool(item["no_knob"]) for item in items.values())
    monkeypatch.setenv("COLUMNS", "200")
    assert run(["list", "policies"]) == 0
    table = capsys.readouterr().out
    assert "bias, 0.005 to 50 (log), finer when higher" in table
    assert items["full"]["no_knob"] in table


def test_metric_ids_are_distinct_and_have_units(capsys: pytest.CaptureFixture[str]) -> None:
    """An id names one metric; each says its unit and which direction is better."""
    items = listed("metrics", capsys)
    assert len({item["id"] for item in items}) == len(items)
    assert all(item["unit"] and item["better"] in {"lower", "higher"} for item in items)


def test_unknown_kind_names_the_known_ones(capsys: pytest.CaptureFixture[str]) -> None:
    """A kind that is not there is refused with those that are."""
    assert run(["list", "polices"]) == 2
    assert "policies" in capsys.readouterr().err
