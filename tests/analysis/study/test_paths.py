"""Paths by name, pattern, file and kind."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.analysis.study.inputs import load_trace
from lodbench.analysis.study.paths import load_paths
from lodbench.base.errors import InputError
from lodbench.models.scene.scene import Scene
from lodbench.traces.cameras.formats.native_csv import write_csv
from lodbench.traces.cameras.generators.generate import KINDS, generate


@pytest.fixture
def recordings(tmp_path: Path) -> Path:
    """Return a folder of three short walks, b before a on disk, and a text."""
    for seed, name in enumerate(("b", "a", "c")):
        write_csv(generate("walk", duration_s=3.0, seed=seed), tmp_path / f"{name}.csv")
    (tmp_path / "notes.txt").write_text("nothing", "utf-8")
    return tmp_path


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_makes_as_many_paths_as_are_asked(kind: str, small_scene: Scene) -> None:
    """Three paths, all different, with their own names; four begin with the same three."""
    three = load_paths([kind], small_scene, paths=3, length_s=4.0)
    four = load_paths([kind], small_scene, paths=4, length_s=4.0)
    assert len({path.name for path in three}) == 3
    for i, path in enumerate(three):
        assert np.array_equal(path.orientation_xyzw, four[i].orientation_xyzw)
        assert path.name == four[i].name
        for other in three[:i]:
            assert not np.array_equal(path.orientation_xyzw, other.orientation_xyzw)


def test_seeds_share_no_path(small_scene: Scene) -> None:
    """What is judged with one seed was not seen with another."""
    first = load_paths(["trial"], small_scene, paths=5, length_s=2.0)
    second = load_paths(["trial"], small_scene, paths=5, length_s=2.0, seed=1)
    starts = {tuple(path.position_m[0].tolist()) for path in (*first, *second)}
    assert len(starts) == 10
    assert not {path.name for path in first} & {path.name for path in second}


def test_lengths_are_the_kinds_own(small_scene: Scene) -> None:
    """A trial takes 12 s, a walk 30 s; a length that is given holds for both."""
    lengths = [path.duration_s for path in load_paths(["trial", "walk"], small_scene)]
    assert lengths == [12.0, 30.0]
    given = load_paths(["trial", "walk"], small_scene, length_s=6.0)
    assert [path.duration_s for path in given] == [6.0, 6.0]


def test_the_bundled_trace_and_files_are_one_path_each(
    small_scene: Scene, recordings: Path
) -> None:
    """However many of a kind are asked for; placed as `load_trace` places them."""
    spec = str(recordings / "a.csv")
    tour, walked = load_paths(["tour", spec], small_scene, "center", paths=7)
    assert np.array_equal(tour.position_m, load_trace("tour", small_scene).position_m)
    placed = load_trace(spec, small_scene, "center")
    assert np.array_equal(walked.position_m, placed.position_m)


def test_patterns_are_sorted_and_each_file_stands_once(
    small_scene: Scene, recordings: Path
) -> None:
    """`*.csv` is a, b, c, although b was named before, which is where it then stands."""
    named = [str(recordings / "b.csv"), str(recordings / "*.csv"), str(recordings / "b.csv")]
    found = load_paths(named, small_scene, "none")
    # Their seeds: b was written with 0, a with 1, c with 2.
    assert [path.name.split()[0] for path in found] == ["walk-0", "walk-1", "walk-2"]
    alone = load_paths([str(recordings / "*.csv")], small_scene, "none")
    assert [path.name for path in alone] == ["walk-1", "walk-0", "walk-2"]


def test_names_are_told_apart(small_scene: Scene, recordings: Path) -> None:
    """Of two files whose traces have one name the later gets a number; one trace twice is one."""
    same = generate("walk", duration_s=3.0)
    for folder in ("x", "y"):
        (recordings / folder).mkdir()
        write_csv(same, recordings / folder / "a.csv")
    found = load_paths([str(recordings / "*" / "a.csv")], small_scene)
    assert [path.name for path in found] == ["walk-0", "walk-0 (2)"]
    assert len(load_paths([same, same], small_scene)) == 1


def test_seconds_cut_every_path(small_scene: Scene, recordings: Path) -> None:
    """Each path is what lies between: its first pose is the whole one's at that time."""
    specs = ["trial", "tour", str(recordings / "a.csv")]
    whole = load_paths(specs, small_scene, paths=2)
    cut = load_paths(specs, small_scene, paths=2, seconds=(1.0, 2.5))
    assert [path.duration_s for path in cut] == [1.5] * 4
    for path, uncut in zip(cut, whole, strict=True):
        assert path.position_m[0].tolist() == pytest.approx(uncut.pose_at(1.0).position_m)
        assert path.position_m[-1].tolist() == pytest.approx(uncut.pose_at(2.5).position_m)
    open_ended = load_paths(["trial"], small_scene, seconds=(1.0, None))
    assert open_ended[0].duration_s == 11.0


@pytest.mark.parametrize(
    ("traces", "options", "said"),
    [
        ([], {}, "traces: expected a name, a file or a kind, got none"),
        (["nothing-*.csv"], {}, r"files that match nothing-\*.csv, got none"),
        (["trail"], {}, "did you mean trial"),
        (["walk"], {"paths": 0}, "paths: expected .* 1"),
        (["walk"], {"paths": 10_001}, "paths: expected at most 10000"),
        (["walk"], {"seed": -1}, "seed: expected"),
        (["walk"], {"seconds": (5.0, 4.0)}, "seconds: expected"),
        (["trial"], {"seconds": (5.0, 13.0)}, "seconds: expected"),
    ],
)
def test_what_cannot_be_is_refused(
    traces: list[str], options: dict[str, int], said: str, small_scene: Scene
) -> None:
    """In one line that says what was wanted."""
    with pytest.raises(InputError, match=said):
        load_paths(traces, small_scene, **options)  # pyright: ignore[reportArgumentType]
