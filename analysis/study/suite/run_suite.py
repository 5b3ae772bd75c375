"""Carry out a suite: a comparison a cell, and who keeps most of them at the best ranks."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from ....base.errors import InputError
from ....models.machine.profile_catalog import load_hardware
from ....models.scene.scene import Scene
from ....models.scene.scene_catalog import load_scene
from ....policies.policy_spec import PolicySpec, is_oracle
from ....policies.registry import parse_policy, require_distinct
from ....sim.replay import ReplayOptions
from ..code_hash import code_hash
from ..compare import CompareSettings, compare
from ..comparison import Comparison
from ..comparison_parts import PolicyResult, knob_text
from ..comparison_target import claimed_target
from ..engine.limits import DEFAULT_LIMITS, Limits
from ..paths import load_paths
from ..runs import Progress
from .definition import Cell, Suite
from .suite_record import CellResult, Leader, Standing, SuiteResult

if TYPE_CHECKING:
    Watch = Callable[[str], AbstractContextManager[Progress | None]]


def run_suite(
    suite: Suite,
    submitted: Sequence[PolicySpec] = (),
    *,
    out: Path | None = None,
    workers: int = 0,
    limits: Limits = DEFAULT_LIMITS,
    scheduler: str | None = None,
    command: str = "",
    watch: "Watch | None" = None,
) -> SuiteResult:
    """Compare the suite's policies and one's own in every cell; return the leaderboard.

    Raises `InputError` if a submitted policy is one of the suite's, an oracle, or refuses its
    parameters.

    Parameters
    ----------
    out
        Folder that gets a folder for each cell, as `compare` writes it.  A cell that it holds is
        not run again, one that was stopped goes on.
    watch
        Called with a cell's name; what it yields is told of the replays.
    """
    specs = [*map(parse_policy, suite.policies), *submitted]
    require_distinct(specs)
    for spec in submitted:
        if is_oracle(spec):
            raise InputError(f"submit {spec.label}: expected a policy, got an oracle")
    scenes: dict[str, Scene] = {}
    cells: list[CellResult] = []
    for cell in suite.cells:
        if cell.scene not in scenes:
            scenes = {cell.scene: load_scene(cell.scene)}  # the last one only: they are large
        settings = CompareSettings(
            warmup_s=suite.warmup_s,
            miss=suite.miss,
            margin=suite.margin,
            seeds=suite.seeds,
            draws=0,
            workers=workers,
            policy_limits=limits,
            scheduler=scheduler,
            command=f"lodbench suite {suite.name}, version {suite.version}: {cell.name}",
        )
        folder = None if out is None else out / cell.name
        with nullcontext() if watch is None else watch(cell.name) as progress:
            found = _compare(suite, cell, specs, scenes[cell.scene], settings, folder, progress)
        cells.append(cell_result(cell, found))
    return SuiteResult(
        suite=suite.name,
        suite_version=suite.version,
        suite_hash=suite.digest,
        command=command,
        version=version("lodbench"),
        code=code_hash(),
        leaderboard=lead(cells, [spec.label for spec in submitted]),
        cells=tuple(cells),
    )


def lead(cells: Sequence[CellResult], submitted: Sequence[str]) -> tuple[Leader, ...]:
    """Return the policies of all cells: by cells kept, then by mean rank there, then by label."""
    by_label: dict[str, list[Standing]] = {}
    for cell in cells:
        for standing in cell.standings:
            by_label.setdefault(standing.label, []).append(standing)
    keys: dict[str, tuple[int, float]] = {}
    for label, standings in by_label.items():
        ranks = [standing.rank for standing in standings if standing.rank is not None]
        keys[label] = (-len(ranks), sum(ranks) / len(ranks) if ranks else float("inf"))
    order = sorted(keys.values())
    return tuple(
        Leader(
            place=1 + order.index(keys[label]),
            label=label,
            submitted=label in submitted,
            kept=-keys[label][0],
            mean_rank=keys[label][1] if keys[label][0] else None,
            failed=sum(one.status == "failed" for one in by_label[label]),
            not_applicable=sum(one.status == "not-applicable" for one in by_label[label]),
        )
        for label in sorted(keys, key=lambda label: (keys[label], label))
    )


def _compare(
    suite: Suite,
    cell: Cell,
    specs: Sequence[PolicySpec],
    scene: Scene,
    settings: CompareSettings,
    folder: Path | None,
    progress: Progress | None,
) -> Comparison:
    """Return the comparison of a cell, from its folder if that holds it."""
    profile = load_hardware(cell.hardware)
    paths = load_paths(
        [cell.trace], scene, paths=suite.paths, length_s=suite.length_s, seed=suite.seed
    )
    options = ReplayOptions(budget_ms=cell.budget_ms, seed=suite.seed, visible_px=suite.visible_px)
    with claimed_target(folder) as target:
        compared = compare(
            specs, scene, paths, profile, options, settings, progress=progress, target=target
        )
        if target is not None:
            target.write(compared)
    return compared.comparison


def cell_result(cell: Cell, comparison: Comparison) -> CellResult:
    """Return what a suite keeps of the comparison of a cell."""
    return CellResult(
        name=cell.name,
        scene=cell.scene,
        trace=cell.trace,
        hardware=cell.hardware,
        budget_ms=cell.budget_ms,
        paths=comparison.paths,
        answer=comparison.answer,
        warnings=comparison.warnings,
        hashes=comparison.provenance.hashes,
        standings=tuple(map(_standing, comparison.policies)),
    )


def _standing(policy: PolicyResult) -> Standing:
    keeps = policy.keeps_budget
    return Standing(
        label=policy.label,
        status=policy.status,
        reason=policy.reason,
        rank=policy.rank,
        keeps=None if keeps is None else keeps.probability,
        knob=knob_text(policy),
        work_ms_p99=None if keeps is None else keeps.work_ms,
        visible_error_px=policy.value_of("visible_error_px"),
        visible_pops_per_s=policy.value_of("visible_pops_per_s"),
        work_ms_mean=policy.value_of("work_ms_mean"),
    )
