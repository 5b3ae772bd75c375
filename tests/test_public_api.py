"""What ``import lodbench`` offers: names, signatures, and results that show themselves."""

import inspect
import pickle
import subprocess
import sys
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import lodbench
from lodbench.analysis.fit.fit import FitOptions
from lodbench.analysis.fit.sampling.sampler import SamplerOptions
from lodbench.analysis.gate.check import CheckPlan
from lodbench.analysis.gate.measurements import MeasureOptions
from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.study.compare import CompareSettings
from lodbench.analysis.study.comparison_folder import read_results
from lodbench.models.machine.profile_catalog import list_hardware
from lodbench.policies.controllers.feedback import Feedback
from lodbench.policies.registry import REGISTERED, parse_policy
from lodbench.sim.frame_log import COUNTS, TIMES
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.read_trace import FORMATS
from lodbench.traces.cameras.trace_format import TraceFormat
from lodbench.traces.logs.log_format import LogFormat
from lodbench.traces.logs.read_log import LOG_FORMATS, read_render_log

CSV = "gpu_ms,triangles\n" + "".join(f"{1 + i % 7},{(i % 7) * 1000}\n" for i in range(60))


class Fine:
    """A policy as one types it: full detail, under a name that HTML would take for a tag."""

    capabilities: ClassVar[lodbench.Capabilities] = lodbench.Capabilities()

    def __init__(self, share: float = 1.0, label: str = "") -> None:
        self.share, self.label = share, label

    def reset(self, scene: object, budget_ms: float) -> None:
        """Nothing to forget."""

    def select(self, view: lodbench.View) -> lodbench.Selection:
        """Return the finest level of everything."""
        return lodbench.Selection(view.ids, np.zeros(len(view)))


SHORT: dict[str, Any] = {
    "scene": "plaza", "traces": "walk", "paths": 1, "seconds": (0.0, 1.5), "seeds": 2,
}  # fmt: skip


def html_of(result: Any) -> str:
    """Return what a notebook shows of a result."""
    return result._repr_html_()


class Broken(Fine):
    """A policy that breaks its contract."""

    def reset(self, scene: Any, budget_ms: float) -> None:
        """Fail in a way of its own."""
        raise RuntimeError("no target")


@pytest.fixture(scope="module")
def compared() -> lodbench.Comparison:
    """Return a comparison of a class, an object, a name, and one that is refused."""
    policies = [Fine, Fine(0.5, "<b>"), "full", Broken]
    return lodbench.compare(policies, **SHORT)


def test_the_list_of_names_is_sorted_and_whole() -> None:
    """`__all__` is sorted, is what `dir` shows, and every name in it leads to something."""
    assert lodbench.__all__ == sorted(lodbench.__all__)
    assert dir(lodbench) == lodbench.__all__
    for name in lodbench.__all__:
        assert getattr(lodbench, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'compair'"):
        lodbench.compair  # noqa: B018


def test_type_checkers_are_told_the_same_names() -> None:
    """A name that is imported for type checkers alone, or only when the program runs, is a trap."""
    source = Path(lodbench.__file__).read_text(encoding="utf-8")
    told = source.split("if TYPE_CHECKING:")[1].split("__all__")[0]
    for home, names in vars(lodbench)["_HOMES"].items():
        (line,) = [line for line in told.splitlines() if f"lodbench.{home} import " in line]
        assert line.split(" import ")[1].split(", ") == list(names)


def test_the_import_is_light() -> None:
    """Until a name is used, neither numpy nor anything built on it is loaded."""
    heavy = ("numpy", "scipy", "pyarrow", "emcee", "trimesh", "plotly", "duckdb")
    script = f"import sys, lodbench; print([n for n in {heavy} if n in sys.modules])"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_signatures_are_those_of_the_design() -> None:
    """What others call by position and by keyword stays; no function takes unnamed keywords."""
    parameters = {
        name: inspect.signature(getattr(lodbench, name)).parameters
        for name in ("load_scene", "load_trace", "load_hardware", "replay", "compare")
    }
    assert list(parameters["load_scene"]) == ["name_or_path"]
    assert list(parameters["load_hardware"]) == ["name_or_path"]
    assert list(parameters["load_trace"]) == ["name_or_path", "scene", "place"]
    assert parameters["load_trace"]["place"].default == "shrink"
    assert list(parameters["replay"])[:4] == ["policy", "scene", "trace", "hardware"]
    assert {"scene", "traces", "hardware", "budget_ms"} <= set(parameters["compare"])
    for name in lodbench.__all__:
        if inspect.isfunction(function := getattr(lodbench, name)):
            kinds = {item.kind for item in inspect.signature(function).parameters.values()}
            assert inspect.Parameter.VAR_KEYWORD not in kinds, name


@pytest.mark.parametrize(
    ("function", "options"),
    [
        ("replay", (ReplayOptions,)),
        ("compare", (ReplayOptions, CompareSettings)),
        ("check", (CheckPlan, MeasureOptions)),
        ("fit", (FitOptions, SamplerOptions)),
    ],
)
def test_defaults_are_those_of_the_options(function: str, options: tuple[Any, ...]) -> None:
    """A keyword has the default of the record that it fills; workers start only when asked for."""
    apart = {"faults", "budget_ms", "workers", "scenes", "traces", "policies", "sampler"}
    apart |= {"fovy_deg"} if function != "check" else set()  # None is what the path states
    given = inspect.signature(getattr(lodbench, function)).parameters
    known = {field.name: field for record in options for field in fields(record)}
    shared = (given.keys() & known.keys()) - apart
    assert shared
    for name in shared:
        assert known[name].default is not MISSING, name
        assert given[name].default == known[name].default, name


def test_a_name_a_class_and_an_object_replay_alike() -> None:
    """The three ways to give a policy lead to the same frames."""
    world = ("plaza", "walk", "desktop-assumed")
    logs = [
        lodbench.replay(policy, *world, budget_ms=16.0, frames=20)
        for policy in ("feedback", Feedback, Feedback())
    ]
    assert len({log.counts.tobytes() for log in logs}) == 1
    assert [log.header.policy for log in logs] == ["feedback", "Feedback", "Feedback"]


def test_names_and_loaded_things_are_one_world() -> None:
    """A scene, trace and profile that were loaded before are those of their names."""
    scene = lodbench.load_scene("plaza")
    things = (scene, lodbench.load_trace("walk", scene), lodbench.load_hardware("desktop-assumed"))
    log = lodbench.replay("full", *things, budget_ms=16.0, frames=10)
    again = lodbench.replay("full", "plaza", "walk", "desktop-assumed", budget_ms=16.0, frames=10)
    assert log.times_ns.tobytes() == again.times_ns.tobytes()


def test_an_object_is_not_worn_out_by_a_replay() -> None:
    """A replay works on a copy, so that an object gives the same frames again."""
    policy = Feedback()
    before = pickle.dumps(policy)
    lodbench.replay(policy, "plaza", "walk", "desktop-assumed", budget_ms=4.0, frames=20)
    assert pickle.dumps(policy) == before


def test_frame_logs_show_themselves() -> None:
    """A log has its columns by name, the same in Arrow, and tells in a line what it is of."""
    log = lodbench.replay(Fine, "plaza", "walk", "desktop-assumed", budget_ms=16.0, frames=20)
    assert len(log) == 20
    assert log.columns == (*TIMES, *COUNTS)
    table = log.to_table()
    assert tuple(table.column_names) == log.columns
    assert np.array_equal(table.column("gpu_ms").to_numpy(), log["gpu_ms"])
    assert repr(log) == "<FrameLog of Fine in plaza on walk-0, desktop-assumed: 20 frames>"
    assert f"<td>{np.median(log['gpu_ms']):.4g}</td>" in html_of(log)


def test_comparisons_show_themselves(compared: lodbench.Comparison) -> None:
    """One row a policy, those that failed too, with values and ends as the record has them."""
    assert repr(compared) == f"<Comparison in plaza, 16.67 ms: {compared.answer[0]}>"
    assert compared.answer[0] in html_of(compared)
    rows = compared.to_table().to_pylist()
    assert [row["policy"] for row in rows] == [policy.label for policy in compared.policies]
    score = compared.policies[0].metrics["work_ms_p95"]
    row = rows[0]
    assert (row["work_ms_p95"], row["work_ms_p95_low"], row["work_ms_p95_high"]) == (
        score.value, *(score.such_paths or (None, None)),
    )  # fmt: skip
    assert {metric.id for metric in METRICS} <= set(row)
    assert rows[3]["work_ms_p95"] is None
    assert "target" in rows[3]["reason"]


def test_names_are_escaped_in_html(compared: lodbench.Comparison) -> None:
    """A label is text, whatever it holds."""
    html = html_of(compared)
    assert "label=&lt;b&gt;" in html
    assert "<b>" not in html


def test_objects_are_told_apart_by_their_parameters(compared: lodbench.Comparison) -> None:
    """An object is labelled by what differs from the defaults, which the record holds as well."""
    found = {policy.label: policy for policy in compared.policies}
    assert found["Fine:share=0.5,label=<b>"].params == {"share": 0.5, "label": "<b>"}
    assert found["Fine"].metrics == found["full"].metrics


def test_a_mapping_gives_labels() -> None:
    """Two objects of one look are told apart by the labels of a mapping, and only so."""
    labelled = lodbench.compare({"a": Fine(), "b": Fine()}, **SHORT)
    assert [policy.label for policy in labelled.policies] == ["a", "b"]
    with pytest.raises(lodbench.InputError, match="Fine twice"):
        lodbench.compare([Fine(), Fine()], **SHORT)


def test_traces_are_one_or_several(tmp_path: Path) -> None:
    """Kinds, traces and names stand beside each other; what is written is what is returned."""
    out = tmp_path / "run"
    walked = lodbench.load_trace("tour", "plaza")
    given: dict[str, Any] = SHORT | {"traces": ["walk", walked], "paths": 2}
    compared = lodbench.compare("full", out=out, **given)
    assert len(compared.paths) == 3
    assert compared.paths[-1] == "tour 0:1.5 s"
    assert compared.window_s == ((1.0, 1.5),) * 3
    read = read_results(out)
    assert read.comparison == compared
    assert read.logs["full"]["input_ns"][-1] <= 1.5e9
    score = compared.policies[0].metrics["work_ms_p95"]
    (row,) = compared.to_table().to_pylist()
    assert (row["work_ms_p95_low"], row["work_ms_p95_high"]) == score.such_paths


def test_check_judges_what_the_command_judges() -> None:
    """A class passes a budget it keeps and fails one it cannot, and the table says which."""
    options: dict[str, Any] = {"seconds": (0.0, 1.5), "seeds": 2, "traces": "walk"}
    coarse = lodbench.check("static-screen:bias=0.005", **options)
    missed = lodbench.check(Fine, budget_ms=1e-3, **options)
    assert (coarse.passed, missed.passed) == (True, False)
    (row,) = missed.to_table().to_pylist()
    assert (row["policy"], row["outcome"], row["metric"]) == ("Fine", "fails", "work_ms_p99")
    assert (row["population"], row["needed"]) == ("such-paths", None)
    assert repr(missed) == "<CheckReport failed: 0 passes, 1 fails, 0 undecided>"
    assert "<td>fails</td>" in html_of(missed)


def test_a_study_is_run_and_shows_itself(tmp_path: Path) -> None:
    """Classes, objects and parameters are axes; in memory and in a folder the rows are the same."""
    study = lodbench.Study(
        {"near": Fine(0.5), "screen": "static-screen", "fronts": "erikson"},
        parameters={"screen": {"first": [0.1, 1.0]}},
        traces="walk",
        budget_ms=[4.0, 8.0],
        seconds=(0.0, 1.2),
    )
    assert len(study) == len(list(study.runs())) == 8
    assert repr(study).startswith("<Study study: 8 runs; policy 3, first 2, scene 1, ")
    results = study.run(workers=1)
    assert repr(results) == "<StudyResults study: 8 runs, 6 ok, 0 failed, 2 not-applicable>"
    assert html_of(results).count("<tr>") == 1 + 8
    rows = results.to_table().to_pylist()
    assert [(row["policy"], row["first"], row["budget_ms"]) for row in rows[2:6]] == [
        ("screen", 0.1, 4.0), ("screen", 0.1, 8.0), ("screen", 1.0, 4.0), ("screen", 1.0, 8.0),
    ]  # fmt: skip
    assert {metric.id for metric in METRICS} <= set(rows[0])
    assert results.to_table().equals(study.run(out=tmp_path / "out", workers=2).to_table())


def test_fit_takes_files_and_logs(tmp_path: Path) -> None:
    """A line through the origin is fitted from a file, and from the log that was read of it."""
    path = tmp_path / "mine.csv"
    path.write_text(CSV, encoding="utf-8")
    options: dict[str, Any] = {"terms": "triangles", "heldout": "none", "max_steps": 200}
    fits = [lodbench.fit(source, **options) for source in (path, [lodbench.read_log(path)])]
    tables = [fit.to_table().to_pylist() for fit in fits]
    assert tables[0] == tables[1]
    slope = next(row for row in tables[0] if row["name"] == "triangles")
    assert slope["mean_ms"] == pytest.approx(1e-3, rel=0.05)
    assert repr(fits[0]).startswith("<Fit of gpu_ms to mine: ")
    assert "<td>triangles</td>" in html_of(fits[0])


def test_bundled_things_go_by_name() -> None:
    """Names lead to what is bundled, and a wrong one is answered with the nearest."""
    assert "peng2011" in lodbench.read_log("peng2011").name
    assert lodbench.load_hardware(list_hardware()[0]).name
    with pytest.raises(lodbench.InputError, match="did you mean plaza"):
        lodbench.load_scene("plazza")


def test_registered_things_go_by_their_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A policy, a trace format and a log format are used by name, and no name of ours is taken."""
    for registry in (REGISTERED, FORMATS, LOG_FORMATS):
        monkeypatch.setattr(registry, "_users", {})
    lodbench.register("fine-policy", Fine)
    assert parse_policy("fine-policy:share=0.5").params == {"share": 0.5}
    assert isinstance(parse_policy("fine-policy").make(), Fine)
    assert "fine-policy" in REGISTERED

    known = FORMATS.find("csv")
    lodbench.register("mine-trace", TraceFormat("x", lambda _: False, known.read))
    lodbench.register("mine-log", LogFormat("x", lambda _: False, LOG_FORMATS.find("csv").read))
    path = tmp_path / "a.csv"
    path.write_text(CSV, encoding="utf-8")
    assert len(read_render_log(path, None, "mine-log").time("gpu_ms")) == 60
    assert "mine-trace" in FORMATS
    for name, thing in (("full", Fine), ("a:b", Fine), ("fine", 3), ("fine", int)):
        with pytest.raises(lodbench.InputError, match=name):
            lodbench.register(name, thing)
