"""Contexts: what is missing is named in one line, and one context leaves another alone."""

import builtins
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from lodbench.base.errors import InputError
from lodbench.render.gl.context import open_target


def without(monkeypatch: pytest.MonkeyPatch, missing: str) -> None:
    """Let the import of a package fail."""
    real = builtins.__import__

    def importing(name: str, *rest: Any, **more: Any) -> Any:
        if name == missing:
            raise ImportError(name)
        return real(name, *rest, **more)

    monkeypatch.delitem(sys.modules, missing, raising=False)
    monkeypatch.setattr(builtins, "__import__", importing)


def test_a_context_closed_leaves_the_next_alone(egl: None) -> None:
    """What is collected after its context closed deletes nothing of the same number elsewhere."""
    first = open_target("egl")
    left = first.context.buffer(b"left")
    first.close()
    second = open_target("egl")
    try:
        kept = second.context.buffer(b"kept")
        assert kept.glo == left.glo
        del left
        assert kept.read() == b"kept"
    finally:
        second.close()


def _rasterisers() -> int:
    """Return how many threads of this process are llvmpipe's own."""
    names = [task.read_text() for task in Path("/proc/self/task").glob("*/comm")]
    return sum(name.startswith("llvmpipe-") for name in names)


def test_each_context_has_the_threads_that_it_asks_for(egl: None) -> None:
    """Also where one before it in the same process had others, once that is closed."""
    for threads in (0, 2, 1, 0):
        opened = open_target("egl", threads=threads)
        if "llvmpipe" not in opened.device.renderer:
            pytest.skip("not a software rasteriser")
        opened.context.simple_framebuffer((64, 64)).clear()
        opened.context.finish()
        found = _rasterisers()
        opened.close()
        assert found == threads
    first, other = open_target("egl", threads=0), open_target("egl")
    with pytest.raises(InputError, match="--threads: expected 0 as of a context that is open"):
        open_target("egl", threads=1)
    other.close()
    first.context.simple_framebuffer((64, 64)).clear()
    first.close()


def test_unknown_backend() -> None:
    """The backends are named."""
    with pytest.raises(InputError, match="--backend: expected one of egl, window, got vulkan"):
        open_target("vulkan")


def test_moderngl_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """The extra to install is named."""
    without(monkeypatch, "moderngl")
    with pytest.raises(InputError, match=r"expected moderngl .* pip install 'lodbench\[gl\]'"):
        open_target("egl")


@pytest.mark.parametrize("kind", [Exception, ImportError, ValueError])
def test_no_driver(monkeypatch: pytest.MonkeyPatch, kind: type[Exception]) -> None:
    """Whatever moderngl raises, one line names the packages of Debian."""
    import moderngl

    def refuse(**_: Any) -> None:
        raise kind("libEGL.so\nnot loaded")

    monkeypatch.setattr(moderngl, "create_context", refuse)
    with pytest.raises(InputError) as caught:
        open_target("egl")
    said = str(caught.value)
    assert "expected OpenGL 4.3 through EGL, got: libEGL.so not loaded; install" in said
    assert all(name in said for name in ("libegl1", "libgl1 ", "libgl1-mesa-dri", "mesa-libEGL"))
    assert "\n" not in said


def test_glfw_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """The extra to install is named, once."""
    without(monkeypatch, "glfw")
    with pytest.raises(InputError) as caught:
        open_target("window")
    assert str(caught.value) == (
        "expected GLFW to open a window, got none; pip install 'lodbench[gl]'"
    )


def test_window_without_a_display(monkeypatch: pytest.MonkeyPatch) -> None:
    """GLFW's reason and the way out, in one line and without its warnings."""
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(InputError) as caught:
        open_target("window")
    said = str(caught.value)
    assert said.startswith("expected a window with OpenGL 4.3, got: ")
    assert "DISPLAY" in said
    assert said.endswith("; record with --backend egl")
    assert said.count("expected") == 1


WINDOW = """
from lodbench.render.gl.context import open_target
target = open_target("window", (64, 48), threads=0)
context = target.context
picture = context.framebuffer([context.renderbuffer((64, 48), 4)])
picture.clear(1.0, 0.5, 0.25, 1.0)
target.show(picture)
target.show(picture)  # the two buffers of the window take turns
print(context.screen.read(components=3, alignment=1).hex())
target.close()
"""


def test_a_window_shows_the_picture() -> None:
    """What was drawn is copied to the window; GLX wants a process without EGL."""
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        pytest.skip("no display to open a window on")
    code = [sys.executable, "-W", "error", "-c", WINDOW]
    found = subprocess.run(code, capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    assert bytes.fromhex(found.stdout) == bytes((255, 128, 64)) * (64 * 48)
