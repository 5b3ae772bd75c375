"""What may stand for a policy: names, classes, objects, several of them, or labels to them."""

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.protocol import Capabilities
from lodbench.policies.registry import REGISTERED, register_policy, spec_of, specs_of
from lodbench.policies.selection import Selection
from lodbench.policies.view import View


@dataclass
class Weighted:
    """A policy with an array among its parameters."""

    weights: Any = field(default_factory=lambda: np.ones(3))
    share: float = 0.5
    capabilities: ClassVar[Capabilities] = Capabilities()

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Forget."""

    def select(self, view: View) -> Selection:
        """Draw everything in full."""
        return Selection(view.ids, np.zeros(len(view)))


def test_an_array_is_no_default_of_a_number() -> None:
    """A parameter whose default is an array may be given a number, and is told apart from it."""
    assert spec_of(Weighted(3, 0.25)).params == {"weights": 3, "share": 0.25}
    assert spec_of(Weighted()).params == {}


def test_several_are_told_from_one() -> None:
    """A list, a set, a generator or a mapping are several; a class or an object is one."""
    assert [spec.label for spec in specs_of(name for name in ("full", "feedback"))] == [
        "full",
        "feedback",
    ]
    assert {spec.label for spec in specs_of({"full", "feedback"})} == {"full", "feedback"}
    assert [spec.label for spec in specs_of({"mine": Full, "theirs": "full"})] == ["mine", "theirs"]
    assert len(specs_of(Weighted())) == len(specs_of(Weighted)) == len(specs_of("full")) == 1


@pytest.mark.parametrize("given", [5, None, [5], [None], [], {}, {"": Full}, {"..": Full}])
def test_what_is_no_policy_is_refused(given: Any) -> None:
    """In one line, whether nothing is given, a number, or a label that could name no file."""
    with pytest.raises(InputError, match="expected"):
        specs_of(given)


@pytest.mark.parametrize("label", ["a\nb", 3])
def test_labels_are_lines_of_text(label: Any) -> None:
    """A label heads a column and names a file."""
    with pytest.raises(InputError, match="expected a label of one line"):
        specs_of({label: Full})


@pytest.mark.parametrize("name", ["a=b", " r ", "a,b", "r/../x", "", 5])
def test_a_name_that_could_not_be_typed_is_refused(name: Any) -> None:
    """A registered name has to be one that the command line can tell from parameters and paths."""
    with pytest.raises(InputError, match="expected a name of its own of letters"):
        register_policy(name, Weighted)
    assert name not in REGISTERED
