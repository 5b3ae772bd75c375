"""Where every number of the page comes from."""

from collections.abc import Iterator

from ...study.comparison import Comparison
from ..blocks import Block, Command, Table
from ..results import Results, section
from ..summary import describe_paths
from ..values import counted


@section("Where the numbers come from")
def provenance(results: Results) -> tuple[Block, ...]:
    """Conditions of the runs; the same ones and the same seed give the same numbers."""
    facts = [(name, results.words(fact)) for name, fact in _facts(results.comparison)]
    table = Table((), facts, "facts")
    command = results.comparison.provenance.command
    return (Command("To repeat it", command), table) if command else (table,)


def _facts(comparison: Comparison) -> Iterator[tuple[str, str]]:
    c, s, made = comparison.conditions, comparison.sampling, comparison.provenance
    measured = "assumed, not measured" if c.hardware_assumed else "measured or published"
    pacing = f"pacing {c.pacing}"
    if c.latency_limit:
        pacing += f", latency limit {c.latency_limit}"
    yield "scene", f"{comparison.scene}, {c.nodes:,} nodes"
    yield "paths", describe_paths(comparison)
    yield "hardware", f"{comparison.hardware}: {measured}; {c.hardware_source}"
    yield "display", f"{c.display}, {c.refresh_hz:g} Hz, {c.width_px} × {c.height_px} px"
    if c.eyes is not None:
        yield "cameras", f"two eyes, {c.eyes}"
    if c.players > 1:
        yield "cameras", f"{c.players} players share the screen"
    in_flight = counted(c.frames_in_flight, "frame")
    yield "pipeline", f"{in_flight} in flight, {pacing}"
    yield "field of view", f"{c.fovy_deg:.4g}° vertical {c.fovy_of}".rstrip()
    yield "cross-fade", f"{c.crossfade_ms:g} ms"
    yield "timers", f"read {counted(c.measurement_delay, 'frame')} after completion"
    yield "budget", f"{comparison.budget_ms:.6g} ms, exceeded for {comparison.miss:.2%} at most"
    yield "visible", f"from {comparison.visible:g} px on; margin {comparison.margin:.0%}"
    yield "seed", f"{comparison.seed}, {counted(s.seeds, 'seed')} a path"
    yield "tuning", s.tuned_on
    draws = f", {counted(s.draws, 'draw')} of the machine" if s.draws else ""
    yield "intervals", f"{s.level:.0%}, {comparison.population}{draws}"
    yield "made by", f"lodbench {made.version}, code {made.code[:12]}"
    for name, digest in made.hashes.items():
        yield f"content of {name}", digest
