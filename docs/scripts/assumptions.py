"""What the first rank rests on: the quick comparison on `desktop-assumed` under other assumptions.

``assumptions.py`` replays the default scene on a variant of the profile for each, and writes the
table of docs/hardware.md; ``assumptions.py NAME`` prints the row of one.
"""

import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from lodbench.analysis.study.compare import (
    DEFAULT_SCENE,
    DEFAULT_TRACE,
    QUICK_LENGTH_S,
    QUICK_PATHS,
    CompareSettings,
    compare,
)
from lodbench.analysis.study.comparison import Comparison
from lodbench.analysis.study.engine.open_engine import prepare_engine
from lodbench.analysis.study.paths import load_paths
from lodbench.base.predictors import CHANGE_PREDICTORS, CPU_PREDICTORS, GPU_PREDICTORS
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions

PAGE = Path(__file__).parents[1] / "hardware.md"
TABLE = re.compile(r"(?<=<!-- assumptions -->\n)(.*?)(?=<!-- /assumptions -->)", re.DOTALL)

IDLE_SHARE = 0.5
"""Of the clock at which a machine idles, over that under load."""

HELPERS = 7
"""Samples shaded for nothing with each triangle that reaches one: micropolygons in quads of 2 x 2
shade eight times what they show (Fatahalian and others, Reducing shading on GPUs using
quad-fragment merging, 2010)."""

HELPER_NS = 1.0
"""Of a helper sample: ten times the price that the profile has of a sample of a sphere."""

HIDDEN = 0.5
"""Share of objects that others hide."""

POLICIES = (
    *("static-distance", "static-screen", "feedback", "funkhouser", "gobbetti", "wimmer", "zach"),
    *("screen-space-error", "pixel-error", "cluster-cut"),
)
"""Ladders, a controller, budget policies and tolerances: of all that a comparison has by default,
those of the first ranks, and of each kind another."""

Variant = Callable[[HardwareProfile], HardwareProfile]


def scaled(
    hardware: HardwareProfile, factors: dict[str, float], more: dict[str, float] | None = None
) -> HardwareProfile:
    """Return a profile with prices of the GPU multiplied, and with others, ms per unit, added."""
    each = [
        ms * factors.get(name, 1.0) + (more or {}).get(name, 0.0)
        for name, ms in zip(GPU_PREDICTORS, hardware.gpu.linear_ms.tolist(), strict=True)
    ]
    return replace(hardware, gpu=replace(hardware.gpu, linear_ms=each))


def with_idling_clock(hardware: HardwareProfile) -> HardwareProfile:
    """Return a profile whose light frames take longer, and whose full ones take what they took.

    The clock goes with the share of the budget that is used, from `IDLE_SHARE`: so a frame of no
    work would take half the budget, of which the rest is left to what it draws.
    """
    budget_ms, share = hardware.budget_ms(None), 1.0 - IDLE_SHARE
    gpu = hardware.gpu
    base_ms = IDLE_SHARE * budget_ms + share * gpu.base_ms
    return replace(hardware, gpu=replace(gpu, base_ms=base_ms, linear_ms=share * gpu.linear_ms))


def with_helpers(hardware: HardwareProfile) -> HardwareProfile:
    """Return a profile that shades helper samples with each triangle that reaches a sample."""
    return scaled(hardware, {}, {"rasterized_triangles": HELPERS * HELPER_NS * 1e-6})


def with_hidden_objects(hardware: HardwareProfile) -> HardwareProfile:
    """Return a profile on which a share of what is drawn is culled before it costs anything."""
    of_objects = ("draw_calls", "triangles", "shaded_samples")
    return scaled(hardware, dict.fromkeys(of_objects, 1.0 - HIDDEN))


def with_free_changes(hardware: HardwareProfile) -> HardwareProfile:
    """Return a profile on which a change of level costs nothing."""
    free: dict[str, float] = dict.fromkeys(CHANGE_PREDICTORS, 0.0)
    linear_ms = [
        0.0 if name in free else ms
        for name, ms in zip(CPU_PREDICTORS, hardware.cpu.linear_ms.tolist(), strict=True)
    ]
    cpu = replace(hardware.cpu, linear_ms=linear_ms)
    return replace(scaled(hardware, free), cpu=cpu)


VARIANTS: dict[str, tuple[str, Variant]] = {
    "plain": ("the profile as it is", lambda hardware: hardware),
    "free-changes": ("changes of level cost nothing", with_free_changes),
    "idling-clock": (f"an idling clock of {IDLE_SHARE:.0%}", with_idling_clock),
    "quads-heavy": (f"{HELPERS} helper samples a triangle, {HELPER_NS:g} ns each", with_helpers),
    "occlusion": (f"{HIDDEN:.0%} of objects culled as hidden", with_hidden_objects),
}


def quick_comparison(variant: Variant) -> Comparison:
    """Return what ``lodbench compare --quick`` says of ten policies on a variant of its profile."""
    hardware, scene = variant(load_hardware("desktop-assumed")), load_scene(DEFAULT_SCENE)
    paths = load_paths([DEFAULT_TRACE], scene, paths=QUICK_PATHS, length_s=QUICK_LENGTH_S)
    policies = [parse_policy(text) for text in POLICIES]
    options = ReplayOptions(budget_ms=hardware.budget_ms(None))
    return compare(policies, scene, paths, hardware, options, CompareSettings(workers=1)).comparison


def row_of(name: str) -> str:
    """Return a row of the table: the assumption, the first rank, and what the second lacks."""
    words, variant = VARIANTS[name]
    comparison = quick_comparison(variant)
    ranked = [policy for policy in comparison.policies if policy.rank is not None]
    first = [policy.label for policy in ranked if policy.rank == 1]
    p_best = comparison.p_best.get(first[0]) if first else None
    second = next((policy for policy in ranked if policy.rank != 1), None)
    behind = f"{second.label}, by `{second.behind_by}`" if second is not None else ""
    sure = "" if p_best is None else f"{p_best:.2f}"
    error = ranked[0].value_of("visible_error_px") if ranked else None
    seen = "" if error is None else f"{error:.2f}"
    return f"| {words} | {', '.join(first) or 'nobody'} | {sure} | {seen} | {behind} |"


def rows() -> Iterator[str]:
    """Yield the rows of the table as they are made."""
    for name in VARIANTS:
        yield row_of(name)


def write_table() -> None:
    """Replace the table of the page."""
    head = "| assumed | first rank, the leader first | P(best) | its error, px | next |"
    table = "\n".join([head, "| --- | --- | --- | --- | --- |", *rows(), ""])
    text, found = TABLE.subn(lambda _: table, PAGE.read_text(encoding="utf-8"))
    assert found == 1, "the page has one place for the table"
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    prepare_engine(None)
    if len(sys.argv) > 1:
        print("\n".join(row_of(name) for name in sys.argv[1:]))
    else:
        write_table()
