"""What is handed to lodbench: names, paths, objects, formats of a user's own, and nonsense."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import lodbench
from lodbench.analysis.study.inputs import as_trace
from lodbench.traces.cameras.read_trace import FORMATS, read_trace
from lodbench.traces.cameras.read_trace import register_format as register_trace_format
from lodbench.traces.cameras.trace_format import TraceFormat
from lodbench.traces.logs.log_format import LogFormat
from lodbench.traces.logs.read_log import LOG_FORMATS, read_render_log
from lodbench.traces.logs.read_log import register_format as register_log_format

LONG = "x" * 5_000
LOADERS: dict[str, Callable[[Any], object]] = {
    "scene": lodbench.load_scene,
    "trace": lambda given: lodbench.load_trace(given, "plaza"),
    "hardware": lodbench.load_hardware,
    "log": lodbench.read_log,
    "log to fit": lodbench.fit,
}

BROKEN = """
from lodbench.base.errors import InputError
from lodbench.traces.cameras.trace_format import TraceFormat
from lodbench.traces.logs.log_format import LogFormat

def fail(*given):
    raise ValueError("no such\\nline")

def refuse(*given):
    raise InputError("expected bars, got none")

def yes(*given):
    return True

TRACE, LOG = TraceFormat("t", fail, fail), LogFormat("l", fail, fail)
WRONG_TRACE, WRONG_LOG = TraceFormat("t", yes, yes), LogFormat("l", yes, lambda path, columns: None)
REFUSED = TraceFormat("t", yes, refuse)
SILENT = TraceFormat("t", yes, lambda path, part: next(iter(())))
"""


@pytest.fixture
def given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a file to be read, beside broken formats in ``own.py``."""
    monkeypatch.setattr(FORMATS, "_users", {})
    monkeypatch.setattr(LOG_FORMATS, "_users", {})
    (tmp_path / "own.py").write_text(BROKEN)
    path = tmp_path / "data.txt"
    path.write_text("1,2\n")
    return path


def message_of(call: Callable[[], object]) -> str:
    """Return the one line of the InputError that a call raises."""
    with pytest.raises(lodbench.InputError) as caught:
        call()
    line = str(caught.value)
    assert "\n" not in line
    return line


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("TRACE", "ValueError: no such"),
        ("SILENT", "StopIteration"),
        ("WRONG_TRACE", "expected a CameraTrace, got bool; return one from read"),
    ],
)
def test_a_broken_trace_format_is_an_input_error(given: Path, name: str, said: str) -> None:
    """A reader that raises, or returns no trace, is named with the file that it was given."""
    own = f"{given.parent / 'own.py'}:{name}"
    assert message_of(lambda: read_trace(str(given), own)) == f"{given}: {own}: {said}"


def test_a_broken_log_format_is_an_input_error(given: Path) -> None:
    """So is a reader of logs."""
    own = f"{given.parent / 'own.py'}:"
    raised = message_of(lambda: lodbench.read_log(given, log_format=f"{own}LOG"))
    assert raised == f"{given}: {own}LOG: ValueError: no such"
    wrong = message_of(lambda: lodbench.read_log(given, log_format=f"{own}WRONG_LOG"))
    assert "expected a RenderLog, got NoneType" in wrong


def test_a_refusal_of_a_users_reader_names_the_file(given: Path) -> None:
    """What a user's reader says in an InputError of its own is kept."""
    own = f"{given.parent / 'own.py'}:REFUSED"
    said = message_of(lambda: read_trace(str(given), own))
    assert said == f"{given}: expected bars, got none"


def test_a_format_that_fails_to_recognise_is_an_input_error(given: Path) -> None:
    """A registered format is shown every file, and one that raises is named."""
    own = f"{given.parent / 'own.py'}:"
    register_trace_format("bars", FORMATS.find(f"{own}TRACE"))
    register_log_format("ticks", LOG_FORMATS.find(f"{own}LOG"))
    assert message_of(lambda: read_trace(str(given))) == f"{given}: bars: ValueError: no such"
    assert message_of(lambda: lodbench.read_log(given)) == f"{given}: ticks: ValueError: no such"


def test_a_fault_of_ours_names_the_file(given: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What our own readers raise by mistake is one line, too: files are damaged in any way."""

    def fail(*_: object) -> Any:
        raise ZeroDivisionError

    fail.__module__ = "lodbench.traces.logs.formats.made_up"
    monkeypatch.setattr(FORMATS, "_users", {"ours": TraceFormat("t", fail, fail)})
    monkeypatch.setattr(LOG_FORMATS, "_users", {"ours": LogFormat("l", fail, fail)})
    for read in (lambda: read_trace(str(given)), lambda: read_render_log(given)):
        assert "cannot be read (ZeroDivisionError" in message_of(read)


def test_objects_are_returned_as_they_are() -> None:
    """What is loaded already needs no loading."""
    scene, hardware = lodbench.load_scene("plaza"), lodbench.load_hardware("llvmpipe")
    trace, log = lodbench.load_trace("tour", scene), lodbench.read_log("peng2011")
    assert lodbench.load_scene(scene) is scene
    assert lodbench.load_hardware(hardware) is hardware
    assert lodbench.load_trace(trace, scene) is trace
    assert lodbench.read_log(log) is log
    assert "give its file" in message_of(lambda: lodbench.read_log(log, log_format="csv"))


def test_a_trace_is_loaded_into_a_scene_by_name() -> None:
    """The scene of a trace may be named, as everywhere."""
    named = lodbench.load_trace("walk", "plaza")
    loaded = lodbench.load_trace("walk", lodbench.load_scene("plaza"))
    assert (named.position_m == loaded.position_m).all()


@pytest.mark.parametrize("load", LOADERS.values(), ids=LOADERS)
@pytest.mark.parametrize("nonsense", [None, 3, b"plaza", 1.5])
def test_what_is_no_name_is_refused(load: Callable[[Any], object], nonsense: object) -> None:
    """Anything but a name, a path or the object itself is an InputError that names its type."""
    said = message_of(lambda: load(nonsense))
    assert "expected a name, a path or a " in said
    assert "got " in said


@pytest.mark.parametrize("load", LOADERS.values(), ids=LOADERS)
@pytest.mark.parametrize("name", [LONG, f"{LONG}/{LONG}", f"{LONG}.toml", f"{LONG}#{LONG}", "a\0b"])
def test_a_name_that_no_file_can_have_is_unknown(load: Callable[[Any], object], name: str) -> None:
    """The system refuses to look for such a file; that is no traceback."""
    assert "expected " in message_of(lambda: load(name))


def test_a_fit_needs_a_log() -> None:
    """An empty list is refused before anything is read."""
    assert message_of(lambda: lodbench.fit([])) == "logs: expected one or more, got none"


def test_place_is_checked_for_an_object_too() -> None:
    """A misspelt way of placing is found even where nothing has to be placed."""
    scene = lodbench.load_scene("plaza")
    trace = lodbench.load_trace("tour", scene)
    for load in (as_trace, lodbench.load_trace):
        said = message_of(lambda load=load: load(trace, scene, "shrunk"))
        assert said.startswith("place: expected shrink, fit, center, none, got shrunk")


def test_objects_show_themselves_in_one_line() -> None:
    """A prompt shows what a thing is, not its arrays."""
    scene = lodbench.load_scene("plaza")
    assert repr(scene) == f"<Scene plaza: {len(scene):,} nodes, {len(scene.types.names)} types>"
    trace = lodbench.load_trace("tour", scene)
    assert repr(trace) == f"<CameraTrace tour: {trace.duration_s:.1f} s, {len(trace):,} poses>"
    assumed = lodbench.load_hardware("desktop-assumed")
    assert repr(assumed).startswith("<HardwareProfile desktop-assumed: ")
    assert repr(assumed).endswith(", assumed>")
    assert "assumed" not in repr(lodbench.load_hardware("llvmpipe"))
    log = lodbench.read_log("peng2011")
    shown = f"{len(log)} frames, {', '.join(log.times)}, {len(log.predictors)} predictors"
    assert repr(log) == f"<RenderLog {log.name}: {shown}>"
