"""The record of a comparison, made from its verdict and from what went into it."""

from collections.abc import Mapping, Sequence
from importlib.metadata import version

from ...base.content_hash import content_hash
from ...base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...traces.cameras.camera_trace import CameraTrace
from ...traces.cameras.shared_screen import split
from ..verdict.scores import LEVEL
from ..verdict.verdict import Verdict
from .code_hash import code_hash
from .comparison import Comparison
from .comparison_parts import Conditions, Provenance, Sampling, UnitCosts
from .field_of_view import whose_field_of_view
from .replays import Bench


def make_comparison(
    verdict: Verdict,
    bench: Bench,
    scene: Scene,
    paths: Sequence[CameraTrace],
    hardware: HardwareProfile,
    sampling: Sampling,
    *,
    population: str,
    margin: float,
    command: str,
) -> Comparison:
    """Return the record of a verdict on judged paths."""
    options = bench.options
    order = verdict.order
    return Comparison(
        scene=scene.name,
        paths=tuple(path.name for path in paths),
        hardware=hardware.name,
        budget_ms=options.budget_ms,
        miss=bench.miss,
        seed=options.seed,
        window_s=tuple((bench.warmup_s, path.duration_s) for path in paths),
        population=population,
        visible=options.visible_px,
        margin=margin,
        conditions=_conditions(bench, scene, paths, hardware),
        sampling=sampling,
        warnings=verdict.warnings,
        answer=verdict.answer,
        policies=verdict.policies,
        p_best=order.p_best,
        p_near_best=order.p_near_best,
        regret=order.regret,
        chances=verdict.chances,
        least_miss=verdict.least_miss,
        curve=verdict.curves,
        worst_moments=verdict.worst_moments,
        robustness=verdict.robustness,
        unit_costs=_unit_costs(hardware),
        provenance=make_provenance(bench, margin, command),
    )


def make_sampling(
    paths: int, seeds: int, draws: int, knobs: Mapping[str, object], variations: int
) -> Sampling:
    """Return in words and numbers how much was replayed, and of what it is a sample."""
    if not knobs:
        tuned_on = "no knob was tuned"
    elif paths == 1:
        tuned_on = f"knobs were tuned on {variations} variations of the path"
    else:
        tuned_on = "knobs were tuned on other paths than those they are judged on"
    return Sampling(LEVEL, seeds, draws, tuned_on)


def make_provenance(bench: Bench, margin: float, command: str) -> Provenance:
    """Return what made a result of a bench."""
    kinds = {bench.scene: "scene", bench.hardware: "hardware"}
    hashes = {  # a scene, a path and a machine may have one name
        f"{kinds.get(digest, 'path')} {value.name}": digest
        for digest, value in bench.inputs.items()
    }
    options = bench.options
    settings = (options.budget_ms, bench.miss, options.visible_px, margin, bench.warmup_s)
    settled = content_hash(*settings, bench.paths)
    return Provenance(command, version("lodbench"), code_hash(), hashes, settled)


def _unit_costs(hardware: HardwareProfile) -> UnitCosts:
    sides = (GPU_PREDICTORS, hardware.gpu.linear_ms), (CPU_PREDICTORS, hardware.cpu.linear_ms)
    gpu, cpu = (
        {name: ms for name, ms in zip(names, unit_ms.tolist(), strict=True) if ms > 0.0}
        for names, unit_ms in sides
    )
    return UnitCosts(gpu, cpu)


def _conditions(
    bench: Bench, scene: Scene, paths: Sequence[CameraTrace], hardware: HardwareProfile
) -> Conditions:
    options, display = bench.options, hardware.display
    return Conditions(
        display=display.mode,
        refresh_hz=display.refresh_hz,
        frames_in_flight=hardware.frames_in_flight,
        pacing=display.pacing,
        latency_limit=display.latency_limit,
        width_px=display.width_px,
        height_px=display.height_px,
        fovy_deg=options.fovy_deg,
        crossfade_ms=options.crossfade_ms,
        measurement_delay=options.measurement_delay,
        nodes=len(scene),
        hardware_source=hardware.provenance.source,
        hardware_assumed=hardware.provenance.assumed,
        fovy_of=whose_field_of_view(paths, options.fovy_deg),
        eyes=options.eyes,
        players=max(len(split(path)) for path in paths),
    )
