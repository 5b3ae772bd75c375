"""Studies as TOML files: what they mean, and what is said about mistakes."""

from pathlib import Path

import pytest

from lodbench.analysis.study.study import Study
from lodbench.analysis.study.sweep.study_file import read_study
from lodbench.base.errors import InputError
from lodbench.traces.cameras.write_trace import write_trace

STUDY = """\
scenes = ["plaza"]
traces = ["tour", "paths/*.csv"]
budget_ms = { from = 8, to = 16, step = 4 }
memory_bytes = ["none", 1e8]
seeds = 2
seconds = "0:5"

[policies]
zach = {}
"mine.py:Near" = { radius_m = [10.0, 20.0] }

[policies.static-screen]
first = { from = 0.01, to = 1, count = 3, log = true }

[[exclude]]
policy = "zach"
budget_ms = [8, 12]

[[exclude]]
trace = "paths/b.csv"
seed = 1
"""

MINE = """
from lodbench import Capabilities, Selection
import numpy as np

class Near:
    capabilities = Capabilities()

    def __init__(self, radius_m: float = 5.0) -> None:
        self.radius_m = radius_m

    def reset(self, scene, budget_ms):
        pass

    def select(self, view):
        return Selection(view.ids, np.zeros(len(view)))
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a policy and three paths, of which two are CSV."""
    (tmp_path / "mine.py").write_text(MINE, encoding="utf-8")
    (tmp_path / "paths").mkdir()
    walk = Study("full", traces="walk")
    trace = walk.inputs[next(walk.runs()).trace]
    for name in ("b.csv", "a.csv", "c.parquet"):
        write_trace(trace, tmp_path / "paths" / name)
    return tmp_path


def write(folder: Path, text: str = STUDY) -> Path:
    """Write a study file beside its paths."""
    path = folder / "budgets.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_is_the_study_that_it_says(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ranges, patterns, parameters and exclusions, from whatever folder it is read."""
    monkeypatch.chdir("/")
    study = read_study(write(folder))
    assert study.name == "budgets"
    assert study.axes == {
        "policy": ("zach", "mine.py:Near", "static-screen"),
        "radius_m": (10.0, 20.0),
        "first": (0.01, 0.1, 1.0),
        "scene": ("plaza",),
        "trace": ("tour", "paths/a.csv", "paths/b.csv"),
        "hardware": ("desktop-assumed",),
        "budget_ms": (8, 12, 16),
        "memory_bytes": (None, 1e8),
        "draw": (None,),
        "seed": (0, 1),
    }
    # By hand: 1 + 2 + 3 variants, each with 3 paths, 3 budgets, 2 bounds and 2 seeds less the seed
    # on one path; zach without two of three budgets.
    assert len(study) == 5 * 3 * 2 * (3 * 2 - 1) + 1 * 2 * (3 * 2 - 1)
    labels = {run.policy.label for run in study.runs()}
    assert "mine.py:Near:radius_m=20.0" in labels
    assert {run.policy.name for run in study.runs()} == {"zach", "mine.py:Near", "static-screen"}


def test_a_file_and_python_make_the_same_runs(folder: Path) -> None:
    """The same axes in Python have the same digests, so that either goes on where the other was."""
    text = 'policies = ["full", "feedback:target=0.8"]\nbudget_ms = [8, 16]\ndisplay = "vsync"\n'
    text += 'pacing = ["none", "limiter"]\nlatency_limit = 1\n'
    of_file = read_study(
        write(folder, text + 'faults = ["none", "missing=0.1"]\nseconds = ":3"\nwarmup_s = 0.5\n')
    )
    from lodbench.sim.machine.faults import Faults

    made = Study(
        ["full", "feedback:target=0.8"],
        budget_ms=[8, 16],
        display="vsync",
        pacing=["none", "limiter"],
        latency_limit=1,
        faults=[Faults(), Faults(missing=0.1)],
        seconds=(0.0, 3.0),
        warmup_s=0.5,
    )
    assert of_file.run_list().digest == made.run_list().digest


MISTAKES = {
    '"plaza"]': ('"plazza"]', 1, "did you mean plaza"),
    "traces": ("tracks", 2, "did you mean traces"),
    "paths/*.csv": ("pats/*.csv", 2, "expected files that match pats/.*, got none"),
    '"tour", "paths': ('"paths/a.csv", "paths', 2, "paths/a.csv: expected each once"),
    "step = 4": ("step = -4", 3, "step: expected steps that lead from 8 to 16, got -4"),
    "to = 16, step": ("to = 16, stop", 3, "did you mean step"),
    "{ from = 8, to = 16, step = 4 }": ('["8"]', 3, "budget_ms: expected a number, got '8'"),
    "1e8": ("-1e8", 4, "memory: expected bytes > 0"),
    "seeds = 2": ("seeds = 0", 5, "seed: expected one value or more"),
    'seconds = "0:5"': ('seconds = "5:0"', 6, "seconds: expected a stretch of tour within 0:"),
    '"0:5"': ('"now"', 6, "seconds: expected A:B, A: or :B in seconds of the path, got 'now'"),
    "seconds =": ("warmup_s = 5\nseconds =", 6, "warmup: expected seconds >= 0 and less than"),
    "zach = {}": ("zack = {}", 9, "did you mean zach"),
    "radius_m =": ("radius =", 10, "did you mean radius_m"),
    "[10.0, 20.0]": ('["wide"]', 10, "radius_m"),
    "from = 0.01": ("from = 0", 13, "log: expected ends above 0, got 0 and 1"),
    "count = 3, log": ("step = 0.1, log", 13, "expected log = true beside count, not step"),
    'policy = "zach"': ('policy = "zac"', 15, "exclude: policy: .* did you mean zach"),
    "[8, 12]": ("[8, 13]", 15, "exclude: budget_ms: expected one of 8, 12, 16, got 13"),
    'trace = "paths/b.csv"': ('path = "paths/b.csv"', 19, "exclude: expected one of policy"),
    "seeds =": ('place = "middle"\nseeds =', 5, "place: expected shrink"),
    "[[exclude]]\ntrace": (
        "[[exclude]]\n[[exclude]]\ntrace",
        19,
        "expected an axis and its values",
    ),
}


@pytest.mark.parametrize("right", MISTAKES)
def test_a_mistake_is_told_with_its_line(folder: Path, right: str) -> None:
    """One line: the file, the line of the key, what was expected and the nearest name."""
    wrong, line, said = MISTAKES[right]
    assert right in STUDY
    path = write(folder, STUDY.replace(right, wrong, 1))
    with pytest.raises(InputError, match=said) as caught:
        read_study(path)
    assert str(caught.value).startswith(f"{path}:{line}: ")
    assert "\n" not in str(caught.value)


def test_a_policy_twice_is_refused(folder: Path) -> None:
    """As every other value of an axis is, with its line."""
    path = write(folder, 'traces = "walk"\npolicies = ["full", "full"]\n')
    with pytest.raises(InputError, match=r":2: policies: expected each once, got full twice"):
        read_study(path)


def test_a_file_that_is_named_wrongly_is_named(folder: Path) -> None:
    """What is wrong in a file of a path is told with that file and not with the study."""
    (folder / "paths" / "a.csv").write_text("nothing\n", encoding="utf-8")
    with pytest.raises(InputError, match="expected a camera trace") as caught:
        read_study(write(folder))
    assert caught.value.path == str(folder / "paths" / "a.csv")
