"""When a timer query is believed: made-up timings for each reason, and what llvmpipe reports."""

from typing import Any

import pytest

from lodbench.render.gl.context import Device
from lodbench.render.gl.measures.timer_query import doubt_timer
from lodbench.render.gl.renderer import Timing

CARD = Device("A card", "1.0", software=False)


def timings(*rows: tuple[float, float, float]) -> list[Timing]:
    """Return timings of CPU, GPU and the whole frame."""
    return [Timing(cpu, gpu, frame, 1) for cpu, gpu, frame in rows]


def test_a_sound_timer_is_believed() -> None:
    """The GPU is busy for most of what the frame's end is waited for."""
    assert doubt_timer(CARD, timings((1.0, 4.0, 5.0), (1.0, 4.1, 5.2), (4.9, 0.2, 5.0))) is None


@pytest.mark.parametrize(
    ("rows", "reason"),
    [
        ([(1.0, 4.0, 5.0), (1.0, 4294.97, 5.0)], "4295.0 ms in a frame of 5.0 ms: a counter"),
        ([(1.0, 4.0, 5.0), (1.0, 0.0, 5.0)], "0 ms: the query is not supported"),
        ([(1.0, 0.05, 5.0), (1.0, 0.04, 5.0)], "0.04 ms where 4.00 ms were waited for"),
    ],
)
def test_each_reason_for_doubt(rows: list[tuple[float, float, float]], reason: str) -> None:
    """A counter that ran over, a query that is not supported, one that answers too soon."""
    doubt = doubt_timer(CARD, timings(*rows))
    assert doubt is not None
    assert reason in doubt


def test_software_is_doubted_whatever_it_reports() -> None:
    """The share that it reports is told."""
    doubt = doubt_timer(Device("x", "1", software=True), timings((1.0, 0.05, 5.0)))
    assert doubt == "a software rasteriser draws in part outside of its query, here 99%"


def test_the_device_of_this_machine(target: Any, drawing: Any, cube: Any) -> None:
    """If it is a software rasteriser, it is known as one, and what it reports is no time."""
    made = drawing([(0.0, 0.0, -3.0)], [[cube()]])
    renderer = made.renderer()
    frame = renderer.prepare(made.picture())
    drawn = [renderer.draw(frame) for _ in range(5)]
    assert all(0.0 < t.cpu_ms <= t.frame_ms for t in drawn)
    software = "llvmpipe" in target.device.renderer
    assert target.device.software is software
    if software:
        assert doubt_timer(target.device, drawn) is not None
        assert target.device.driver.startswith("Mesa ")
