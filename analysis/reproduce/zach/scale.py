"""Section 4: 1.4 million trees, and a selection in time."""

from collections.abc import Mapping
from statistics import fmean

import numpy as np

from ....base.predictors import LEVEL_PREDICTORS
from ....models.scene.scene_catalog import load_scene
from ...study.engine.task import Beat
from ..experiment import Claim, Experiment, Findings, verdict_of
from ..trial import Numbers, Trial, trial
from .fig2 import PRINTED
from .selections import MACHINE, SCENE

_TREES, _GROUP, _HEIGHTS = 1_400_000, 64, 2_049
_BUDGET_MS, _SELECTION_MS = 100.0, 50.0


def count(*, beat: Beat) -> Numbers:
    """Return what the scene has."""
    beat(0)
    scene = load_scene(SCENE)
    levels = scene.types.levels
    finest = levels.counts[levels.start[:-1]][scene.type_index]
    trees, splats = (finest[:, LEVEL_PREDICTORS.index(name)] for name in ("draw_calls", "splats"))
    groups = splats > 0.0
    patches = (trees > 0.0) & ~groups
    side = np.sqrt(np.count_nonzero(patches[scene.child_start[1:] == scene.child_start[:-1]]))
    return {
        "nodes": len(scene),
        "trees": float(trees[groups].sum()),
        "groups": int(groups.sum()),
        "largest": float(trees[groups].max()),
        "heights": float(32.0 * side + 1.0),
    }


def _trials(reduced: bool) -> list[Trial]:
    arguments = {"budget_ms": _BUDGET_MS, "splitting": True, "frames": 2 if reduced else 40}
    function = "zach.selections:measure"
    return [
        trial("scene", "zach.scale:count", {}),
        trial("printed", function, arguments),
        trial("admission", function, {**arguments, "admission": True}),
    ]


def _judge(numbers: Mapping[str, Numbers], _reduced: bool) -> Findings:
    scene, printed, admitted = (numbers[key] for key in ("scene", "printed", "admission"))
    counts = (scene["trees"], scene["largest"], scene["heights"])
    claims = (
        Claim(
            "trees, most in a group, heights along a side",
            f"{_TREES:,}, {_GROUP}, {_HEIGHTS:,}",
            f"{counts[0]:,.0f}, {counts[1]:.0f}, {counts[2]:,.0f}",
            "the same",
            verdict_of(counts == (_TREES, _GROUP, _HEIGHTS), "the scene differs"),
        ),
        Claim(
            "all groups in view share the time, none is refused beforehand",
            '"the remaining nodes are passed to the selection"',
            f"{min(printed['groups']):,} to {max(printed['groups']):,} groups in view, as "
            f"{min(printed['variables']):,} to {max(printed['variables']):,} variables",
            "",
            verdict_of(min(printed["groups"]) > 0, "nothing is in view"),
        ),
    )
    return Findings(claims, (), _notes(scene, printed, admitted))


def _notes(scene: Numbers, printed: Numbers, admitted: Numbers) -> tuple[str, ...]:
    in_view = fmean(printed["trees_in_view"])
    worth = [
        fmean(one["terrain_benefit"]) + fmean(one["tree_benefit"]) for one in (admitted, printed)
    ]
    in_time = printed["wall_ms"] <= _SELECTION_MS
    return (
        (
            f"A selection over {scene['nodes']:,} nodes took {printed['wall_ms']:.0f} ms as "
            f"printed, {admitted['wall_ms']:.0f} with admission, median processor time on the "
            f"machine that wrote this page: {'' if in_time else 'not '}within {_SELECTION_MS:g} ms."
        ),
        (
            f"Were all {in_view:,.0f} trees in view set up, as the printed cost may be read, it "
            f"alone would take {2.45e-3 * in_view:,.0f} ms of the {_BUDGET_MS:g}; so a tree not "
            "drawn is taken not to be set up."
        ),
        (
            f"With admission, ours, a mean frame is worth {worth[0] / worth[1]:.3f} times one as "
            "printed, by the paper's own benefit."
        ),
    )


SCALE = Experiment(
    id="zach/scale",
    title="1.4 million trees",
    setting=f"{SCENE} on {MACHINE} under zach, with and without admission, 100 ms, frames evenly "
    "along the flight.",
    constants=PRINTED,
    trials=_trials,
    judge=_judge,
)
