"""The contract of a selection: one deliberately broken selection for each message."""

import re
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.tree import Tree
from lodbench.policies.selection import Selection, Work, find_violation

MakeScene = Callable[..., Scene]
MakeLevels = Callable[..., LevelTable]
CANDIDATES = np.array([0, 1, 3], dtype=np.int32)
PREDICTED = "predicted_ms: expected milliseconds from 0 to 1e+09 or NaN"
SCALE = "render_scale: expected a number from 0.0010 to 1"


class LyingCount(int):
    """A number that is less than everything, and says so at length."""

    __slots__ = ()
    __le__ = __lt__ = __ge__ = __gt__ = lambda self, _: True  # pyright: ignore[reportAssignmentType]

    def __str__(self) -> str:
        """Refuse to be printed."""
        raise KeyboardInterrupt


class LyingArray(np.ndarray):
    """An array that says of every comparison that it holds."""

    def __array_ufunc__(self, *_: object, **__: object) -> Any:
        """Return true."""
        return np.True_


def of_class(kind: Any, array: Any) -> Any:
    """Return an array as one of a subclass."""
    return array.view(kind)


@pytest.fixture(scope="module")
def mixed(make_scene: MakeScene, make_levels: MakeLevels) -> Scene:
    """Return five nodes: 0, 1 and 4 have three levels, 2 and 3 resolutions from 0.1."""
    levels = make_levels([(100, 50, 10), (100, 10)], continuous=[False, True])
    return make_scene([(0, 0, 0)] * 5, kind=[0, 0, 1, 1, 0], levels=levels)


def check(scene: Scene, ids: Any = CANDIDATES, detail: Any = (0.0, 2.0, 0.5), **more: Any) -> Any:
    """Return the violation of a selection with the given parts; lists of details become arrays."""
    given = np.array(detail) if type(detail) in {list, tuple} else detail
    return find_violation(Selection(ids, given, **more), CANDIDATES, scene)


def test_good_selections_pass(mixed: Scene) -> None:
    """Everything, a part in another order, nothing, and borrowing within a type are allowed."""
    assert check(mixed) is None
    assert check(mixed, np.array([3, 0]), (0.1, 2.0)) is None
    assert check(mixed, CANDIDATES.astype(np.int64)) is None
    assert check(mixed, np.array([], dtype=int), np.array([])) is None
    assert check(mixed, holder=np.array([1, 1, 2]), predicted_ms=3.0) is None


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"ids": [0, 1, 3]}, "ids: expected a one-dimensional numpy array, got list"),
        ({"ids": CANDIDATES[None]}, "ids: expected a one-dimensional numpy array, got ndarray"),
        ({"ids": CANDIDATES * 1.0}, "ids: expected integers, got float64"),
        ({"detail": "fine"}, "detail: expected a one-dimensional numpy array, got str"),
        ({"detail": np.zeros(3, int)}, "detail: expected float64, got int"),
        ({"detail": np.zeros(3, np.float32)}, "detail: expected float64, got float32"),
        ({"detail": [0.0, 1.0]}, "detail: expected 3 values as in ids, got 2"),
        ({"detail": [np.nan, 0.0, 1.0]}, "detail of node 0: expected a level from 0 to 2, got nan"),
        ({"detail": [0.0, 3.0, 1.0]}, "detail of node 1: expected a level from 0 to 2, got 3"),
        ({"detail": [0.0, -1.0, 1.0]}, "detail of node 1: expected a level from 0 to 2, got -1"),
        ({"detail": [0.5, 0.0, 1.0]}, "detail of node 0: expected a level from 0 to 2, got 0.5"),
        ({"detail": [0.0, np.inf, 1.0]}, "detail of node 1: expected a level from 0 to 2, got inf"),
        ({"detail": [0.0, 0.0, 0.05]}, "node 3: expected a resolution from 0.1 to 1, got 0.05"),
        ({"detail": [0.0, 0.0, 1.01]}, "node 3: expected a resolution from 0.1 to 1, got 1.01"),
        ({"detail": [0.0, 0.0, np.nan]}, "node 3: expected a resolution from 0.1 to 1, got nan"),
        ({"ids": np.array([0, 1, 9])}, "ids: expected 0 to 4, got 0 to 9"),
        ({"ids": np.array([-1, 1, 3])}, "ids: expected 0 to 4, got -1 to 3"),
        ({"ids": np.array([0, 0, 3])}, "ids: expected distinct nodes, got a node twice"),
        ({"ids": np.array([0, 4, 3])}, "ids: expected candidates of the view, got node 4"),
        ({"holder": np.zeros(2, int)}, "holder: expected 3 values as in ids, got 2"),
        ({"holder": np.zeros(3)}, "holder: expected integers, got float64"),
        ({"holder": np.array([0, 1, 7])}, "holder: expected 0 to 4, got 0 to 7"),
        ({"holder": np.array([0, 1, 1])}, "holder of node 3: expected its type, got node 1 of"),
        ({"work": 7}, "work: expected a Work, got int"),
        ({"work": Work(-1)}, "work: expected objects_visited from 0 to 1e+12, got -1"),
        ({"work": Work(0, np.nan)}, "work: expected comparisons from 0 to 1e+12, got nan"),  # pyright: ignore[reportArgumentType]  # broken on purpose
        ({"work": Work(0, 0, None)}, "work: expected iterations from 0 to 1e+12, got None"),  # pyright: ignore[reportArgumentType]  # broken on purpose
        ({"predicted_ms": "soon"}, f"{PREDICTED}, got soon"),
        ({"predicted_ms": -1.0}, f"{PREDICTED}, got -1"),
    ],
)
def test_each_broken_selection_has_its_message(
    mixed: Scene, parts: dict[str, Any], message: str
) -> None:
    """A single fault in an otherwise good selection is named, with what was expected and got."""
    assert message in check(mixed, **parts)


NUMBERS: list[tuple[Any, str]] = [
    (10**400, "1" + 38 * "0" + "…"),
    (10**5000, "an unprintable int"),
    (10**12 + 1, "1000000000001"),
    (np.inf, "inf"),
    (-np.inf, "-inf"),
    (1e300, "1e+300"),
    (1.0 + 1.0j, "(1+1j)"),
    (np.complex128(1.0), "(1+0j)"),
    (True, "True"),
    (np.True_, "True"),
    (Decimal(1), "1"),
    (Fraction(1, 2), "1/2"),
    (np.longdouble(1.0), "1.0"),
    (np.float16(1.0), "1.0"),
    (np.timedelta64(1, "s"), "1 seconds"),
    (np.ma.masked, "--"),
    (np.array(1.0), "1.0"),
    (LyingCount(1), "an unprintable LyingCount"),
    ("\x1b[2J\n7", "?[2J 7"),
]
"""Numbers of no use, which not even pytest can print all, and how they are told."""


@pytest.mark.parametrize("at", range(len(NUMBERS)))
def test_numbers_of_no_use_are_named_in_every_field(mixed: Scene, at: int) -> None:
    """Huge, complex, masked, and what only says that it is a number: all are told in brief."""
    value, got = NUMBERS[at]
    for field in ("objects_visited", "comparisons", "iterations"):
        work = Work(**{field: value})
        assert check(mixed, work=work) == f"work: expected {field} from 0 to 1e+12, got {got}"
    assert check(mixed, render_scale=value) == f"{SCALE}, got {got}"
    assert check(mixed, predicted_ms=value) == f"{PREDICTED}, got {got}"


def test_numbers_at_their_bounds_are_allowed(mixed: Scene) -> None:
    """Each bound itself passes, as an int, a float or a number of numpy."""
    for most in (10**12, 1e12, np.int64(10**12), np.uint64(10**12), np.float64(1e12), np.int8(3)):
        assert check(mixed, work=Work(most, most, most)) is None  # pyright: ignore[reportArgumentType]  # what numpy returns
    for predicted_ms in (0, 1e9, np.float64(1e9), np.float32(1e9), np.nan, np.float32(np.nan)):
        assert check(mixed, predicted_ms=predicted_ms) is None
    for scale in (1, 1.0, 1.0 / 1024.0, np.float64(0.5), np.float32(1.0 / 1024.0)):
        assert check(mixed, render_scale=scale) is None
    assert check(mixed, render_scale=1e-300) == f"{SCALE}, got 1e-300"
    assert check(mixed, render_scale=0) == f"{SCALE}, got 0"
    assert check(mixed, render_scale=np.nan) == f"{SCALE}, got nan"


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"ids": np.ma.masked_array(CANDIDATES)}, "ids: expected a one-dim.* got MaskedArray"),
        ({"ids": of_class(LyingArray, CANDIDATES)}, "ids: expected a one-dim.* got LyingArray"),
        ({"detail": np.ma.masked_invalid([0.0, np.nan, 0.5])}, "detail: .* got MaskedArray"),
        ({"detail": of_class(LyingArray, np.full(3, 9.0))}, "detail: .* got LyingArray"),
        ({"detail": of_class(np.matrix, np.zeros(3))}, "detail: .* got matrix"),
        ({"detail": np.zeros(3, dtype=complex)}, "detail: expected float64, got complex128"),
        ({"detail": np.zeros(3, dtype=object)}, "detail: expected float64, got object"),
        ({"detail": np.zeros(3, dtype=np.float16)}, "detail: expected float64, got float16"),
        ({"detail": np.zeros(3, dtype="m8[s]")}, "detail: expected float64, got timedelta64"),
        ({"ids": np.zeros(3, dtype=np.bool_)}, "ids: expected integers, got bool"),
        ({"ids": CANDIDATES.astype(object)}, "ids: expected integers, got object"),
        ({"ids": CANDIDATES.astype(np.uint32)}, "ids: expected integers, got uint32"),
        ({"ids": np.array(1)}, "ids: expected a one-dimensional numpy array"),
        ({"holder": np.ma.masked_array(CANDIDATES)}, "holder: expected a one-dim"),
        ({"wanted": np.ma.masked_array(CANDIDATES)}, "wanted: expected a one-dim"),
        (
            {
                "ids": np.broadcast_to(np.int64(0), (10**12,)),
                "detail": np.broadcast_to(0.0, (10**12,)),
            },
            "ids: expected distinct nodes, got 1000000000000 of 5",
        ),
        ({"wanted": np.broadcast_to(np.int64(0), (10**12,))}, "wanted: .* got 1000000000000 of 5"),
    ],
)
@pytest.mark.filterwarnings("ignore:the matrix subclass")
def test_arrays_of_no_use_are_named(mixed: Scene, parts: dict[str, Any], message: str) -> None:
    """Masked, complex and object arrays, subclasses that lie, and lengths that no memory holds."""
    assert re.match(message, check(mixed, **parts))


def test_arrays_may_lie_in_memory_as_they_like(mixed: Scene) -> None:
    """Negative strides, none at all, the other order of bytes, and read-only memory are fine."""
    detail = np.array([0.5, 2.0, 0.0])[::-1]
    assert check(mixed, CANDIDATES[::-1][::-1], detail) is None
    assert check(mixed, detail=np.broadcast_to(1.0, (3,))) is None
    assert check(mixed, CANDIDATES.astype(">i8"), detail.astype(">f8")) is None
    assert check(mixed, np.frombuffer(CANDIDATES.tobytes(), np.int32)) is None


def test_subclasses_are_no_selections(mixed: Scene) -> None:
    """What could answer otherwise at the next question is refused by its type."""

    class Mine(Selection):
        __slots__ = ()

    class MyWork(Work):
        __slots__ = ()

    assert find_violation(Mine(CANDIDATES, np.zeros(3)), CANDIDATES, mixed) == (
        "expected a Selection, got Mine"
    )
    assert check(mixed, work=MyWork()) == "work: expected a Work, got MyWork"


def test_something_else_than_a_selection(mixed: Scene) -> None:
    """None and a bare array are refused by their type."""
    assert find_violation(None, CANDIDATES, mixed) == "expected a Selection, got NoneType"
    got = find_violation(np.zeros(3), CANDIDATES, mixed)
    assert got == "expected a Selection, got ndarray"


def test_a_scene_of_discrete_types_alone(make_scene: MakeScene) -> None:
    """Without continuous types the same faults are found."""
    scene = make_scene([(0, 0, 0)] * 4)
    assert check(scene, detail=[0.0, 1.0, 2.0]) is None
    for bad in (3.0, -1.0, 0.5, np.nan):
        assert f"node 3: expected a level from 0 to 2, got {bad:g}" in check(
            scene, detail=[0.0, 1.0, bad]
        )


def test_a_front_of_a_tree(make_scene: MakeScene, make_levels: MakeLevels) -> None:
    """In a tree any nodes may be drawn, but none below another that replaces it."""
    levels = make_levels([(10,)])
    scene = make_scene([(0, 0, 0)] * 5, levels=levels, parent=[-1, 0, 0, 1, 1])
    tree = Tree(scene)
    roots = scene.roots

    def violation(*ids: int) -> str | None:
        selection = Selection(np.array(ids), np.zeros(len(ids)))
        return find_violation(selection, roots, scene, tree)

    assert violation(0) is None
    assert violation(2, 3, 4) is None
    assert violation(3, 2) is None
    assert violation(0, 4) == "ids: expected a front, got node 4 below another that replaces it"
    added = make_scene([(0, 0, 0)] * 2, levels=levels, parent=[-1, 0], additive=True)
    both = Selection(np.array([0, 1]), np.zeros(2))
    assert find_violation(both, added.roots, added, Tree(added)) is None
