"""An OpenGL context: off screen through EGL, or of a window."""

import os
import re
from ctypes import c_uint, c_void_p, cast
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...base.errors import InputError
from .measures.gl_functions import Loader, gl_function
from .process_memory import keep_memory

if TYPE_CHECKING:
    import moderngl

BACKENDS = ("egl", "window")

_VERSION = 430  # storage buffers
_SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader", "warp")
_EGL_PACKAGES = (
    "install libegl1, libgl1 and libgl1-mesa-dri (Debian, Ubuntu) or mesa-libEGL, mesa-libGL and "
    "mesa-dri-drivers (Fedora), or the EGL library of the GPU's driver"
)
_WINDOW = f"a window with OpenGL {_VERSION / 100:.1f}"
_NO_WINDOW = "record with --backend egl"


@dataclass(frozen=True, slots=True)
class Device:
    """What draws.

    Attributes
    ----------
    renderer, driver : as OpenGL names them, the driver with its version
    software : whether it is known to draw on the processor
    """

    renderer: str
    driver: str
    software: bool

    @property
    def caller_draws(self) -> bool:
        """Whether it draws in the caller's thread where it is given no threads."""
        return "llvmpipe" in self.renderer


@dataclass(frozen=True, slots=True, eq=False)
class _Held:
    """What a context off screen holds of its process: a display, and the threads of its driver."""

    display: int
    threads: int | None


_held: list[_Held] = []  # of the contexts that are open


@dataclass(slots=True)
class Target:
    """A context and, if it has a window, what shows a finished picture there.

    Attributes
    ----------
    context : moderngl.Context
    device : Device
    load : Loader
        Of functions of OpenGL that moderngl lacks.
    window : handle of GLFW, or None off screen
    held : what it shares with other contexts, off screen
    """

    context: "moderngl.Context"
    device: Device
    load: Loader
    window: Any = None
    held: _Held | None = None

    def show(self, picture: "moderngl.Framebuffer") -> None:
        """Copy a picture to the window, if there is one."""
        if self.window is None:
            return
        import glfw

        self.context.copy_framebuffer(self.context.screen, picture)
        glfw.swap_buffers(self.window)
        glfw.poll_events()
        self.context.finish()  # or the next frame would wait for this one to be shown

    def close(self) -> None:
        """Give the context back, and with it all that was made in it."""
        self.context.gc_mode = "context_gc"  # what is collected later may not delete another's
        self.context.release()
        if self.held is not None:
            _held.remove(self.held)
            if not _held:  # the next context may want another number of threads
                display, each = self.held.display, (c_void_p,) * 4
                gl_function(self.load, "eglMakeCurrent", c_uint, *each)(display, None, None, None)
                gl_function(self.load, "eglTerminate", c_uint, c_void_p)(display)
        if self.window is not None:
            import glfw

            glfw.destroy_window(self.window)


def open_target(
    backend: str, size_px: tuple[int, int] = (640, 360), *, threads: int | None = None
) -> Target:
    """Open a context of OpenGL 4.3 or later.

    Raises `InputError` if a package is missing, with its name, or no driver offers a context.

    Parameters
    ----------
    backend
        One of `BACKENDS`.
    size_px
        Width and height of the window.
    threads
        Threads of Mesa's software rasteriser, 0 for none but the caller's; None leaves it be.  All
        contexts that are open at a time have the same.  What it frees stays with the process.
    """
    try:
        import moderngl
    except ImportError as error:
        message = "expected moderngl to draw with, got none; pip install 'lodbench[gl]'"
        raise InputError(message) from error
    if threads is not None:
        os.environ["LP_NUM_THREADS"] = str(threads)
        keep_memory()
    if backend not in BACKENDS:
        raise InputError(f"--backend: expected one of {', '.join(BACKENDS)}, got {backend}")
    try:
        if backend == "window":
            return _windowed(moderngl, size_px)
        return _off_screen(moderngl, threads)
    except InputError:
        raise
    except Exception as error:  # moderngl raises plain Exception, and ImportError for libraries
        what = " ".join(str(error).split()) or type(error).__name__
        if backend == "window":
            raise InputError(f"expected {_WINDOW}, got: {what}; {_NO_WINDOW}") from error
        message = f"expected OpenGL {_VERSION / 100:.1f} through EGL, got: {what}; {_EGL_PACKAGES}"
        raise InputError(message) from error


def _off_screen(moderngl: Any, threads: int | None) -> Target:
    import glcontext

    for other in _held:
        if threads is not None and other.threads not in {None, threads}:
            message = f"expected {other.threads} as of a context that is open, got {threads}"
            raise InputError(f"--threads: {message}; close that before")
    # Made here, not by moderngl, which keeps its loader to itself.
    backends: Any = glcontext  # which has no stubs
    egl = backends.get_backend_by_name("egl")(mode="standalone", glversion=_VERSION)
    target = _target(moderngl.create_context(require=_VERSION, context=egl), egl.load)
    display: int = gl_function(egl.load, "eglGetCurrentDisplay", c_void_p)()
    target.held = _Held(display, threads)
    _held.append(target.held)
    return target


def _windowed(moderngl: Any, size_px: tuple[int, int]) -> Target:
    try:
        import glfw
    except ImportError as error:
        message = "expected GLFW to open a window, got none; pip install 'lodbench[gl]'"
        raise InputError(message) from error
    glfw.ERROR_REPORTING = "ignore"  # instead of warnings: the last error tells
    window = _open_window(glfw, size_px) if glfw.init() else None
    if window is None:
        what: Any = glfw.get_error()[1]
        reason = what.decode(errors="replace") if what else "none"
        raise InputError(f"expected {_WINDOW}, got: {reason}; {_NO_WINDOW}")
    glfw.make_context_current(window)
    glfw.swap_interval(0)  # a wait for the screen is no cost of the frame

    def load(name: str) -> int:
        return cast(glfw.get_proc_address(name), c_void_p).value or 0

    return _target(moderngl.create_context(require=_VERSION), load, window)


def _open_window(glfw: Any, size_px: tuple[int, int]) -> Any:
    glfw.window_hint(glfw.RESIZABLE, False)
    glfw.window_hint(glfw.CONTEXT_VERSION_MAJOR, _VERSION // 100)
    glfw.window_hint(glfw.CONTEXT_VERSION_MINOR, _VERSION // 10 % 10)
    glfw.window_hint(glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE)
    return glfw.create_window(*size_px, "lodbench", None, None) or None


def _target(context: "moderngl.Context", load: Loader, window: Any = None) -> Target:
    context.gc_mode = "auto"  # give back what Python no longer refers to
    return Target(context, _device(context), load, window)


def _device(context: "moderngl.Context") -> Device:
    renderer, version = context.info["GL_RENDERER"], context.info["GL_VERSION"]
    match = re.search(r"Mesa \S+|NVIDIA \S+|\d+(\.\d+)+$", version)
    software = any(name in renderer.lower() for name in _SOFTWARE)
    return Device(renderer, match[0] if match else version, software)
