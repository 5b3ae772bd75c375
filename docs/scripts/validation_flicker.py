"""Whether what is computed of flicker is what pictures show of it: tables of `validation.md`.

Usage: ``python docs/scripts/validation_flicker.py [FOLDER]`` (part of ``make validation``), some
four minutes; pictures stay in FOLDER, by default out/validation/flicker.  With ``--write`` the
tables are written from pictures that are there.
"""

import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from page_parts import table, write_blocks
from validation_figures import Table, read_table

from lodbench.base.arrays import FloatArray
from lodbench.cli.main import run

DOCS = Path(__file__).parents[1]
POLICIES = ("static-distance", "static-screen", "feedback", "lodmanager", "funkhouser", "gobbetti")
# Small pictures of one frame in four: a fast camera, and a budget that makes policies switch.
SCENE = ("--scene", "market", "--trace", "drive", "--seconds", "0:5", "--budget-ms", "3")
DRAWING = ("--size", "160x90", "--repeats", "1", "--image-every", "4")

Statistic: TypeAlias = Callable[[list[FloatArray]], float]
"""Takes what `steps_of` returns of each policy."""

_LOW, _HIGH = 0.05, 0.95
_BLOCK_S = 1.0  # of the path: pictures nearer to each other than this are alike


def flicker_by_policy(tables: Mapping[str, Table]) -> Iterator[tuple[str, ...]]:
    """Yield what each policy switches, computed and in its pictures, a second of the path."""
    yield (
        *("policy", "steps", "with a switch, %", "`popping_px_per_s`"),
        *("switch, FLIP/s", "step less held step, FLIP/s"),
    )
    for policy, columns in tables.items():
        steps = steps_of(columns)
        rates = steps.sum(axis=1) / _seen_s(columns)
        share = 100.0 * float((steps[0] > 0.0).mean())
        yield policy, f"{steps.shape[1]}", f"{share:.0f}", *(f"{rate:.2g}" for rate in rates)


def flicker_ranks(tables: Mapping[str, Table], resamples: int = 1_000) -> Iterator[tuple[str, ...]]:
    """Yield Spearman's ρ of popping and what pictures show of switches, with 90 % intervals.

    Over pictures the intervals are of a bootstrap over policies and blocks of a second of each
    path; over the order of policies, which are as they are, over the blocks alone.
    """
    yield "Spearman's ρ of `popping_px`", "switch", "step less held step"
    steps = [steps_of(columns) for columns in tables.values()]
    blocks = [max(1, round(_BLOCK_S * len(c["frame"]) / _span_s(c))) for c in tables.values()]
    seconds = np.array([_seen_s(columns) for columns in tables.values()])
    rows: dict[str, tuple[Callable[[int], Statistic], bool]] = {
        "all steps": (_over_steps, True),
        "steps with a switch": (_over_switches, True),
        "order of the policies": (lambda shown: _over_policies(shown, seconds), False),
    }
    for title, (statistic, policies_too) in rows.items():
        spans: list[str] = []
        for shown in (1, 2):
            rng = np.random.default_rng(shown)
            made = statistic(shown)
            low, high = interval(steps, blocks, made, rng, resamples, policies_too=policies_too)
            spans.append(f"{made(steps):.2f} [{low:.2f}, {high:.2f}]")
        yield title, *spans


def steps_of(columns: Table) -> FloatArray:
    """Return (3, n) of each step: popping, FLIP of the switch, FLIP of step less held step.

    These are what would be seen of it under a still camera, and on top of the motion.
    """
    moving = columns["step_flip"] - columns["held_step_flip"]
    steps = np.stack((columns["popping_px"], columns["switch_flip"], moving))
    return steps[:, np.isfinite(moving)]


def interval(
    steps: list[FloatArray],
    blocks: list[int],
    statistic: Statistic,
    rng: np.random.Generator,
    resamples: int,
    *,
    policies_too: bool,
) -> tuple[float, float]:
    """Return the 90 % interval of a statistic by a circular block bootstrap.

    With `policies_too` policies are drawn first, with replacement, then blocks of each.
    """
    found: list[float] = []
    for _ in range(resamples):
        chosen = rng.integers(len(steps), size=len(steps)) if policies_too else range(len(steps))
        found.append(statistic([_resampled(steps[i], blocks[i], rng) for i in chosen]))
    low, high = np.nanquantile(found, (_LOW, _HIGH))
    return float(low), float(high)


def _resampled(steps: FloatArray, block: int, rng: np.random.Generator) -> FloatArray:
    count = len(steps[0])
    start = rng.integers(count, size=-(-count // block))
    at = (start[:, None] + np.arange(block)).ravel()[:count] % count
    return steps[:, at]


def _over_steps(shown: int) -> Statistic:
    return lambda steps: _rho(*np.concatenate(steps, axis=1)[[0, shown]])


def _over_switches(shown: int) -> Statistic:
    def rho(steps: list[FloatArray]) -> float:
        joined = np.concatenate(steps, axis=1)
        return _rho(*joined[:, joined[0] > 0.0][[0, shown]])

    return rho


def _over_policies(shown: int, seconds: FloatArray) -> Statistic:
    def rho(steps: list[FloatArray]) -> float:
        rates = np.array([policy.sum(axis=1) for policy in steps]).T / seconds
        return _rho(*rates[[0, shown]])

    return rho


def _rho(first: FloatArray, second: FloatArray) -> float:
    """Return Spearman's ρ; nan where one side does not tell any two apart."""
    from scipy.stats import rankdata

    if len(first) < 2 or np.ptp(first) == 0.0 or np.ptp(second) == 0.0:
        return float("nan")
    ranks: Any = [rankdata(first), rankdata(second)]
    return float(np.corrcoef(ranks)[0, 1])


def _span_s(columns: Table) -> float:
    """Return seconds of the path from the first picture to the last."""
    return float(columns["trace_s"][-1] - columns["trace_s"][0])


def _seen_s(columns: Table) -> float:
    """Return seconds of the path that the compared steps took: one of every so many frames."""
    every = float(columns["frame"][1] - columns["frame"][0])
    return _span_s(columns) / every


def measure(folder: Path) -> None:
    """Record each policy with its pictures."""
    folder.mkdir(parents=True, exist_ok=True)
    for policy in POLICIES:
        out = ("--images", f"{folder / policy}", "--out", f"{folder / 'log.parquet'}")
        if run(("record", *SCENE, *DRAWING, "--policy", policy, *out)) != 0:
            sys.exit("error: lodbench record failed")


def main() -> None:
    """Measure, unless all is there, then write."""
    folders = [Path(argument) for argument in sys.argv[1:] if not argument.startswith("--")]
    folder = folders[0] if folders else DOCS.parent / "out" / "validation" / "flicker"
    if "--write" not in sys.argv[1:]:
        measure(folder)
    tables = {policy: read_table(folder / policy / "images.csv") for policy in POLICIES}
    blocks = {
        "flicker": table(*flicker_by_policy(tables)),
        "flicker_ranks": table(*flicker_ranks(tables)),
    }
    write_blocks(DOCS / "validation.md", "docs/scripts/validation_flicker.py", blocks)


if __name__ == "__main__":
    main()
