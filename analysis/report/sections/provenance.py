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
    start_s, end_s = comparison.window_s
    yield "window", f"{start_s:g} to {end_s:g} s of the path, the same for every policy"
    yield "visible", f"errors, and changes of error, of {comparison.visible_px:g} px or more"
    drawn = f"{i.level:.0%} of {i.draws} posterior draws of the cost model, the same for all"
    yield "intervals", drawn if i.draws else "none: the profile has no posterior draws"
    yield "made by", f"lodbench {__version__}"
