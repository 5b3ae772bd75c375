"""Where every number of the page comes from."""

from collections.abc import Iterator

from ....base.version import __version__
from ...study.comparison import Comparison
from ..blocks import Table
from ..results import Results, section


@section("Where the numbers come from")
def provenance(results: Results) -> tuple[Table]:
    """Conditions of the run; the same ones and the same seed give the same numbers."""
    return (Table((), list(_facts(results.comparison)), "facts"),)


def _facts(comparison: Comparison) -> Iterator[tuple[str, str]]:
    c, i = comparison.conditions, comparison.intervals
    measured = "assumed, not measured" if c.hardware_assumed else "measured or published"
    yield "scene", f"{comparison.scene}, {c.nodes:,} nodes"
    yield "trace", f"{comparison.trace}, {c.trace_s:.2f} s"
    yield "hardware", f"{comparison.hardware}: {measured}; {c.hardware_source}"
    yield "display", f"{c.display}, {c.refresh_hz:g} Hz, {c.width_px} × {c.height_px} px"
    yield "pipeline", f"{c.frames_in_flight} frames in flight, fovy {c.fovy_deg:g}°"
    yield "cross-fade", f"{c.crossfade_ms:g} ms"
    yield "timers", f"read {c.measurement_delay} frames after completion"
    yield "budget", f"{comparison.budget_ms:.6g} ms"
    yield "seed", str(comparison.seed)
    yield "warm-up", f"the first {comparison.warmup} frames of each replay are not counted"
    draws = f", pooled over {i.draws} posterior draws of the cost model" if i.draws else ""
    sampled = f"{i.level:.0%} of {i.resamples} resamples of blocks of 1/{i.blocks} of the run"
    yield "intervals", f"{sampled}{draws}; same blocks, draws and noise for every policy"
    yield "made by", f"lodbench {__version__}"
