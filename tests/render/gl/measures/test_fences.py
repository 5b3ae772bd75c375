"""Fences: reached once what was drawn before them is, and not to be waited for forever."""

from ctypes import CFUNCTYPE, c_uint, c_uint64, c_void_p, cast
from typing import Any

import pytest

from lodbench.base.errors import InputError
from lodbench.render.gl.measures.fences import Fences


def test_what_is_behind_a_fence_is_drawn(target: Any, drawing: Any, cube: Any) -> None:
    """Fences are reached in the order in which they were set."""
    made, fences = drawing([(0.0, 0.0, -3.0)], [[cube()]]), Fences(target.load)
    renderer = made.renderer()
    frame = renderer.prepare(made.picture())
    first, second = (_drawn(renderer, frame, fences) for _ in range(2))
    assert fences.reached(second, wait=True)
    assert fences.reached(first, wait=False)


def _drawn(renderer: Any, frame: Any, fences: Fences) -> int:
    renderer.submit(frame, renderer.framebuffer(frame.size_px))
    return fences.set()


@pytest.mark.parametrize(("state", "wait"), [(0x911B, True), (0x911D, False)])
def test_a_device_that_hangs(target: Any, state: int, wait: bool) -> None:
    """A wait that ends without the fence, or fails, is told in one line."""
    stub = CFUNCTYPE(c_uint, c_void_p, c_uint, c_uint64)(lambda *_: state)
    address = cast(stub, c_void_p).value or 0
    fences = Fences(lambda name: address if name == "glClientWaitSync" else target.load(name))
    with pytest.raises(InputError, match="expected the device to finish a frame within a minute"):
        fences.reached(fences.set(), wait=wait)


def test_a_fence_that_is_not_reached_yet(target: Any) -> None:
    """Asked, not waited for, it is False, and can be asked again."""
    states = iter([0x911B, 0x911A])
    stub = CFUNCTYPE(c_uint, c_void_p, c_uint, c_uint64)(lambda *_: next(states))
    address = cast(stub, c_void_p).value or 0
    fences = Fences(lambda name: address if name == "glClientWaitSync" else target.load(name))
    fence = fences.set()
    assert not fences.reached(fence, wait=False)
    assert fences.reached(fence, wait=False)
