"""Studies: which runs they ask for, and in what they are replayed."""

from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.study.study import Study
from lodbench.base.errors import InputError
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.thresholds.static_screen import StaticScreen
from lodbench.sim.machine.faults import Faults
from lodbench.traces.cameras import read_trace as reading
from lodbench.traces.cameras.write_trace import write_trace


def cells_of(study: Study, *names: str) -> list[tuple[Any, ...]]:
    """Return the cells on some axes, run by run."""
    return [tuple(case.cells.get(name) for name in names) for case in study.cases()]


def test_every_combination_is_a_run() -> None:
    """Policy slowest and seed fastest, each run with its own options and its place on the axes."""
    study = Study(["full", "zach"], budget_ms=[8, 16], seeds=2, warmup_s=0.5)
    assert cells_of(study, "policy", "budget_ms", "seed") == [
        ("full", 8, 0), ("full", 8, 1), ("full", 16, 0), ("full", 16, 1),
        ("zach", 8, 0), ("zach", 8, 1), ("zach", 16, 0), ("zach", 16, 1),
    ]  # fmt: skip
    runs = list(study.runs())
    assert [(run.policy.label, run.options.budget_ms, run.options.seed) for run in runs] == (
        cells_of(study, "policy", "budget_ms", "seed")
    )
    assert {run.warmup_s for run in runs} == {0.5}
    assert len({run.digest for run in runs}) == len(study) == 8


def test_parameters_vary_in_their_own_policy() -> None:
    """A policy has as many runs as its parameters have combinations; others have no such column."""
    grid = {"static-screen": {"first": [0.1, 1], "bias": [0.5, 1.0]}}
    study = Study(["full", "static-screen"], parameters=grid)
    assert cells_of(study, "policy", "first", "bias") == [
        ("full", None, None),
        ("static-screen", 0.1, 0.5), ("static-screen", 0.1, 1.0),
        ("static-screen", 1.0, 0.5), ("static-screen", 1.0, 1.0),
    ]  # fmt: skip
    made = [run.policy.make() for run in study.runs()][1:]
    assert [(one.first, one.bias) for one in made if isinstance(one, StaticScreen)] == [
        (0.1, 0.5), (0.1, 1.0), (1.0, 0.5), (1.0, 1.0),
    ]  # fmt: skip
    labels = [run.policy.label for run in study.runs()]
    assert labels[1] == "static-screen:first=0.1,bias=0.5"


def test_a_parameter_named_as_a_column_has_another() -> None:
    """`memory_bytes` is a condition of the replay and a parameter of a policy: two columns."""
    varied = {"screen-space-error": {"memory_bytes": [1e6, 1e7]}}
    study = Study("screen-space-error", parameters=varied, memory_bytes=[None, 1e8])
    assert cells_of(study, "param_memory_bytes", "memory_bytes") == [
        (1e6, None), (1e6, 1e8), (1e7, None), (1e7, 1e8),
    ]  # fmt: skip


def test_a_budget_of_none_is_one_refresh() -> None:
    """The column has the milliseconds, by the display that the run has."""
    study = Study("full", refresh_hz=[None, 100, 50], display="vsync")
    own = 1e3 / load_hardware("desktop-assumed").display.refresh_hz
    assert cells_of(study, "refresh_hz", "budget_ms") == [(None, own), (100, 10.0), (50, 20.0)]
    machines = [study.inputs[run.hardware] for run in study.runs()]
    assert [machine.display.mode for machine in machines] == ["vsync"] * 3
    assert [machine.display.refresh_hz for machine in machines][1:] == [100, 50]


def test_pacing_is_an_axis_and_part_of_what_a_run_is() -> None:
    """Machines that pace otherwise are other machines, by their content."""
    study = Study("full", pacing=["none", "just-in-time"], latency_limit=[None, 0])
    assert cells_of(study, "pacing", "latency_limit") == [
        ("none", None), ("none", 0), ("just-in-time", None), ("just-in-time", 0),
    ]  # fmt: skip
    assert len({run.hardware for run in study.runs()}) == 4
    displays = [study.inputs[run.hardware].display for run in study.runs()]
    assert [display.pacing for display in displays] == ["none"] * 2 + ["just-in-time"] * 2
    assert [display.latency_limit for display in displays] == [2, 0, 2, 0]


def test_draws_are_those_that_each_profile_has() -> None:
    """The first draws of a scatter cover it; a profile without one plays its mean."""
    study = Study("full", hardware=["desktop-assumed", "llvmpipe"], draws=2)
    assert load_hardware("desktop-assumed").posterior is None
    assert load_hardware("llvmpipe").scatter.occasion > 0.0
    assert cells_of(study, "hardware", "draw") == [
        ("desktop-assumed", None), ("llvmpipe", 0), ("llvmpipe", 1),
    ]  # fmt: skip
    mean = Study("full", hardware="llvmpipe", draws=[None, 3])
    assert [run.options.draw for run in mean.runs()] == [None, 3]


def test_exclusions_leave_runs_out() -> None:
    """By the values of any axis: a policy's parameter, the mean in place of a draw, a path."""
    study = Study(
        ["full", "static-screen"],
        parameters={"static-screen": {"first": [0.1, 1.0]}},
        traces=["tour", "walk"],
        hardware="llvmpipe",
        draws=[None, 0],
        exclude=[{"first": 0.1, "trace": "walk"}, {"policy": "full", "draw": ["mean"]}],
    )
    assert cells_of(study, "policy", "first", "trace", "draw") == [
        ("full", None, "tour", 0), ("full", None, "walk", 0),
        ("static-screen", 0.1, "tour", None), ("static-screen", 0.1, "tour", 0),
        ("static-screen", 1.0, "tour", None), ("static-screen", 1.0, "tour", 0),
        ("static-screen", 1.0, "walk", None), ("static-screen", 1.0, "walk", 0),
    ]  # fmt: skip


def test_parameters_that_do_not_go_together_are_refused_before_the_work() -> None:
    """Each value has a partner that it goes with: the one pair that is wrong can be left out."""
    grid = {"hoppe": {"start_px": [1.0, 100.0], "max_px": [64.0, 200.0]}}
    with pytest.raises(InputError, match=r"start_px <= max_px, got 0[.]1, 100, 64"):
        Study("hoppe", parameters=grid).run_list()
    exclude = [{"start_px": 100.0, "max_px": 64.0}]
    assert len(Study("hoppe", parameters=grid, exclude=exclude).run_list().runs) == 3
    with pytest.raises(InputError, match="expected target in"):
        Study("hoppe", parameters={"hoppe": {"target": [0.9, 2.0]}})
    with pytest.raises(InputError, match="expected target in"):
        Study(["full", "hoppe:target=2"])


def test_inputs_are_loaded_once_and_only_where_they_are_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, small_scene: Scene
) -> None:
    """A file of a path is read once and placed in each scene that has a run on it."""
    write_trace(Study("full").inputs[next(Study("full").runs()).trace], tmp_path / "a.csv")
    read: list[str] = []
    known = reading.read_trace

    def counted(spec: str) -> Any:
        read.append(spec)
        return known(spec)

    monkeypatch.setattr("lodbench.analysis.study.axes.study_inputs.read_trace", counted)
    path = str(tmp_path / "a.csv")
    scenes = {"one": "plaza", "two": small_scene}
    exclude = [{"scene": "two", "trace": "walk"}]
    study = Study(
        ["full", "zach"], scenes=scenes, traces={"mine": path, "walk": "walk"}, exclude=exclude
    )
    runs = list(study.runs())
    assert read == [path]
    assert {run.trace for run in runs} | {run.scene for run in runs} <= set(study.inputs)
    # Two scenes, two placed paths in one and one in the other, and a machine.
    assert len(study.inputs) == 2 + 3 + 1
    assert {run.trace for run in runs} == {run.trace for run in runs if run.policy.label == "zach"}


def test_objects_go_by_their_names() -> None:
    """What was loaded or made needs no file, and conditions are those of a replay."""
    scene, machine = load_scene("plaza"), load_hardware("llvmpipe")
    faults = [Faults(), Faults(missing=0.1, saturated_ms=20.0)]
    study = Study(StaticScreen, scenes=scene, hardware=machine, faults=faults, crossfade_ms=200.0)
    assert cells_of(study, "policy", "scene", "hardware", "faults", "crossfade_ms") == [
        ("StaticScreen", "plaza", "llvmpipe", "none", 200.0),
        ("StaticScreen", "plaza", "llvmpipe", "missing=0.1,saturated_ms=20", 200.0),
    ]  # fmt: skip
    assert [run.options.faults for run in study.runs()] == faults
    assert study.inputs[next(study.runs()).scene] is scene


def test_the_digest_is_of_what_is_run() -> None:
    """Equal studies have one digest, and each thing that changes a run or a column another."""
    given: dict[str, Any] = {"policies": ["full"], "budget_ms": [8, 16], "seconds": (0.0, 5.0)}
    same = Study(**given).run_list().digest
    assert Study(**given, name="other").run_list().digest == same
    changed: list[dict[str, Any]] = [
        {"budget_ms": [8, 17]}, {"seconds": (0.0, 5.5)}, {"warmup_s": 0.9}, {"policies": ["zach"]},
        {"traces": "walk"}, {"scenes": {"mine": "plaza"}}, {"exclude": [{"budget_ms": 8}]},
        {"seeds": [1]}, {"refresh_hz": 60}, {"visible_px": 2.0},
    ]  # fmt: skip
    digests = {Study(**(given | change)).run_list().digest for change in changed}
    assert len(digests | {same}) == len(changed) + 1


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"parameters": {"zack": {}}}, "parameters: expected one of zach, got zack"),
        ({"parameters": {"zach": {"epsilom": 1}}}, "did you mean epsilon"),
        ({"exclude": [{"scene": "plazza"}]}, "exclude: scene: expected one of plaza"),
        ({"budget_ms": [8, -1]}, "budget: expected milliseconds > 0, got -1"),
        ({"seeds": 0}, "seed: expected one value or more, got none"),
        ({"draws": [2]}, "draw"),
        ({"display": "vsnyc"}, "display mode: expected immediate"),
        ({"pacing": ["none", "slow"]}, "pacing: expected none, limiter, just-in-time, got slow"),
        ({"seeds": range(3_000_000), "budget_ms": [8, 9, 10, 11]}, "got 12,000,000; take fewer"),
    ],
)
def test_mistakes_are_told_before_anything_is_loaded(given: dict[str, Any], said: str) -> None:
    """A study that cannot be is refused when it is made."""
    with pytest.raises(InputError, match=said):
        Study("zach", **given)


def test_a_path_that_is_all_warm_up_is_refused() -> None:
    """As `compare` refuses it, before a worker would."""
    with pytest.raises(InputError, match="warmup: expected seconds >= 0 and less than the path's"):
        Study("full", seconds=(4.0, 5.0), warmup_s=1.0).inputs  # noqa: B018


def test_every_path_is_cut_to_the_same_seconds() -> None:
    """A study over a stretch replays nothing else, and keeps the names of its axis."""
    study = Study("full", traces=["tour", "walk"], seconds=(4.0, 6.5))
    assert cells_of(study, "trace") == [("tour",), ("walk",)]
    paths = [study.inputs[run.trace] for run in study.runs()]
    assert [path.duration_s for path in paths] == [2.5, 2.5]
    assert [path.name for path in paths] == ["tour 4:6.5 s", "walk-0 4:6.5 s"]
