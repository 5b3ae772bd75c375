"""The render log: its shape, its names, and which frames measure something."""

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.render_log import RenderLog, measurable


def log_of(frame_ms: list[float], triangles: list[float], **times: list[float]) -> RenderLog:
    """Make a log of one predictor."""
    return RenderLog(
        name="log",
        format="csv",
        predictors=("triangles",),
        counts=np.array(triangles)[:, np.newaxis],
        frame_ms=np.array(frame_ms),
        gpu_ms=np.array(times["gpu_ms"]) if "gpu_ms" in times else None,
    )


def test_columns_cannot_be_written_to():
    """A log is a value: its arrays are read-only copies."""
    times = [1.0, 2.0]
    log = log_of(times, [1.0, 1.0])
    assert log.frame_ms is not None
    assert not log.frame_ms.flags.writeable
    assert not log.counts.flags.writeable


def test_each_frame_left_out_is_counted_once_under_its_first_reason():
    """Of ten frames five are no measurements, for five reasons, and two more are first frames."""
    frame_ms = [9.0, 9.0, np.nan, 0.0, -1.0, 4294.967296, np.inf, 9.0, 9.0, 9.0]
    triangles = [5.0, 5.0, 5.0, 5.0, 5.0, 5.0, 5.0, np.nan, -3.0, 5.0]
    keep, rejections = measurable(
        log_of(frame_ms, triangles), "frame_ms", ["triangles"], first_frames=2
    )
    assert keep.tolist() == [False] * 9 + [True]
    assert [str(rejection) for rejection in rejections] == [
        "2 frame_ms that is missing or not finite",
        "2 frame_ms that is zero or negative",
        "1 frame_ms of a timer that ran over",
        "2 a predictor that is missing or negative",
        "2 first frames (1 to 2)",
    ]
    assert sum(rejection.count for rejection in rejections) == 9


def test_a_broken_timer_spoils_only_its_own_column():
    """A wrapped gpu_ms leaves the frame's frame_ms a measurement."""
    log = log_of([9.0, 9.0], [5.0, 5.0], gpu_ms=[4294.9673, 3.0])
    on_frame, _ = measurable(log, "frame_ms", ["triangles"], first_frames=0)
    on_gpu, _ = measurable(log, "gpu_ms", ["triangles"], first_frames=0)
    assert on_frame.tolist() == [True, True]
    assert on_gpu.tolist() == [False, True]


def test_what_is_missing_is_named():
    """A fit that asks for more than the log has hears what is there."""
    log = log_of([9.0], [5.0])
    with pytest.raises(InputError, match=r"predictors vertices, splats, got a log with triangles"):
        log.columns(["triangles", "vertices", "splats"])
    with pytest.raises(InputError, match="the time cpu_ms, got a log with frame_ms"):
        log.time("cpu_ms")


@pytest.mark.parametrize(
    ("predictors", "counts", "says"),
    [
        (("tris",), np.ones((2, 1)), "known predictors"),
        (("splats", "splats"), np.ones((2, 2)), "distinct"),
        (("splats",), np.ones((2, 2)), "shape"),
        (("splats",), np.ones((3, 1)), "shape"),
        (("splats",), np.ones((0, 1)), "at least one frame|shape"),
    ],
)
def test_inconsistent_columns_are_refused(
    predictors: tuple[str, ...], counts: np.ndarray, says: str
):
    """Names must be known and as many as columns, and columns as long as the times."""
    with pytest.raises(InputError, match=says):
        RenderLog("log", "csv", predictors, counts, frame_ms=np.ones(2))
