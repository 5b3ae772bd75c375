"""Measure this machine, validate the simulator on it, and write what `validation.md` reports.

Usage: ``python docs/scripts/validation_tables.py [FOLDER]`` (``make validation``), some twenty
minutes on a quiet machine; logs and pages stay in FOLDER, by default out/validation.  With
``--bundle`` the new log and profile also replace those of `llvmpipe` in the package.
"""

import json
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from page_parts import table, write_blocks
from validation_figures import draw_pictures, draw_series, draw_similarity, read_table

from lodbench.analysis.fit.bundled_logs import bundled_fit
from lodbench.cli.main import run
from lodbench.cli.validate import POLICIES

DOCS = Path(__file__).parents[1]
PROFILE = DOCS.parent / "models" / "profiles" / "llvmpipe.toml"
LOG = DOCS.parent / "analysis" / "fit" / "logs" / "llvmpipe.parquet"
TERMS = bundled_fit("llvmpipe").terms
WITHOUT = "draw_calls,triangles,framebuffer_pixels"
HELD = ("frame_ms_mean", "frame_ms_sd", "over_budget_time_fraction", "lag_ms_mean", "sse_px_p95")
PICTURED = ("static-distance", "static-screen", "feedback", "lodmanager", "funkhouser", "gobbetti")
BUDGET_MS, SECONDS, SIZE = "5", "10", ("--size", "640x360")


def lodbench(*arguments: str) -> None:
    """Run a command, or stop where it fails."""
    print("lodbench", *arguments, flush=True)
    if run(arguments) != 0:
        sys.exit(f"error: lodbench {arguments[0]} failed")


def measure(folder: Path) -> None:
    """Calibrate on one scene, validate on another, and compare pictures along a walk."""
    log, profile = folder / "llvmpipe.parquet", folder / "llvmpipe.toml"
    lodbench(
        "record", "--calibrate", "--scene", "plaza", "--trace", "tour", *SIZE, "--out", f"{log}"
    )
    lodbench("fit", f"{log}", "--terms", TERMS, "--target", "frame_ms", "--out", f"{profile}")
    poor = folder / "without.toml"
    lodbench("fit", f"{log}", "--terms", WITHOUT, "--target", "frame_ms", "--out", f"{poor}")
    same = ("--scene", "market", "--trace", "drive", "--budget-ms", BUDGET_MS, "--seconds", SECONDS)
    first = folder / "market-drive"
    lodbench("validate", *same, "--hardware", f"{profile}", "--out", f"{first}")
    again = ("--recorded", f"{first}", "--out", f"{folder / 'without'}")
    lodbench("validate", *same, "--hardware", f"{poor}", *again)
    picture(folder)


def picture(folder: Path) -> None:
    """Compare pictures of each policy with full detail along a walk."""
    profile = folder / "llvmpipe.toml"
    (folder / "images").mkdir(exist_ok=True)
    for policy in PICTURED:
        pictures = ("--images", f"{folder / 'images' / policy}", "--image-every", "250")
        walk = ("--scene", "market", "--trace", "walk", "--budget-ms", BUDGET_MS, *SIZE)
        out = ("--repeats", "1", "--out", f"{folder / 'walk.parquet'}")
        lodbench("record", *walk, "--hardware", f"{profile}", "--policy", policy, *pictures, *out)


def conditions(found: dict[str, Any]) -> Iterator[tuple[str, ...]]:
    """Yield what was measured on what."""
    log = found["log"]
    yield "", ""
    yield "renderer", f"{log['renderer']}, {log['driver']}"
    yield "processor", log["processor"]
    yield "date", log["date"]
    yield "picture", f"{log['resolution']}, {log['repeats']} drawings a frame, the median counts"
    yield "calibrated on", f"{', '.join(found['measured_on'])}: {found['hardware_source']}"
    yield "validated on", f"{found['scene']} along {found['trace']}, the first {SECONDS} s"
    yield "budget", f"{found['budget_ms']:g} ms"


def errors(found: dict[str, Any], poor: dict[str, Any]) -> Iterator[tuple[str, ...]]:
    """Yield errors of frame times of each policy and of all."""
    yield (
        *("policy", "frames", "model", "without rasterized triangles"),
        *("model with v_time", "simulated replay", "recorded again"),
    )
    rows = [(p["label"], p["frames_measured"], p["errors"]) for p in found["policies"]]
    rows.append(("**all**", sum(row[1] for row in rows), found["all_policies"]))
    others = [p["errors"] for p in poor["policies"]] + [poor["all_policies"]]
    for (label, frames, error), other in zip(rows, others, strict=True):
        cells = (error["model"], other["model"], error["v_time"], error["simulation"])
        yield label, f"{frames:,}", *map(plus_minus, (*cells, error["again"]))


def plus_minus(error: dict[str, float] | None) -> str:
    """Return mean and deviation, in per cent."""
    return "–" if error is None else f"{error['mean_pct']:+.1f} ± {error['sd_pct']:.1f}"


def agreement(found: dict[str, Any]) -> Iterator[tuple[str, ...]]:
    """Yield metrics measured and simulated, and how they order the policies."""
    yield "policy", *(f"`{name}`" for name in HELD)
    for policy in found["policies"]:
        cells: list[str] = []
        for name in HELD:
            item = policy["metrics"][name]
            span = "" if item["low"] is None else f" ({item['low']:.3g} to {item['high']:.3g})"
            mark = "" if item["inside"] is not False else " ✗"
            cells.append(f"{item['measured']:.3g}, {item['simulated']:.3g}{span}{mark}")
        yield policy["label"], *cells
    ranks = [found["ranks"].get(name) for name in HELD]
    yield "Kendall's τ", *("–" if r is None else f"{r['simulated']:.2f}" for r in ranks)
    yield (
        "τ of both recordings",
        *("–" if r is None or r["again"] is None else f"{r['again']:.2f}" for r in ranks),
    )


def pictures(tables: dict[str, dict[str, np.ndarray[Any, Any]]]) -> Iterator[tuple[str, ...]]:
    """Yield how pictures of each policy differ from full detail."""
    yield "policy", "pictures", "SSIM, mean", "worst", "difference, %", "`sse_px_p95`", "benefit, %"
    for policy, columns in tables.items():
        yield (
            *(policy, f"{len(columns['ssim'])}"),
            *(f"{columns['ssim'].mean():.4f}", f"{columns['ssim'].min():.4f}"),
            f"{100.0 * columns['difference'].mean():.3f}",
            f"{columns['sse_px_p95'].mean():.2f}",
            f"{100.0 * columns['benefit_share'].mean():.1f}",
        )


def ranks(tables: dict[str, dict[str, np.ndarray[Any, Any]]]) -> Iterator[tuple[str, ...]]:
    """Yield rank correlations of what is computed with what the pictures show."""
    from scipy.stats import spearmanr

    joined = {
        name: np.concatenate([columns[name] for columns in tables.values()])
        for name in next(iter(tables.values()))
    }
    yield "Spearman's ρ over all pictures", "1 − SSIM", "difference"
    computed = {
        "`sse_px_p95`": joined["sse_px_p95"],
        "`sse_px_max`": joined["sse_px_max"],
        "1 − benefit share": 1.0 - joined["benefit_share"],
    }
    for title, values in computed.items():
        rho = [spearmanr(values, joined[shown])[0] for shown in ("ssim", "difference")]
        yield title, f"{-rho[0]:.2f}", f"{rho[1]:.2f}"


def write(folder: Path) -> None:
    """Write tables and figures from what was measured."""
    found = json.loads((folder / "market-drive" / "validation.json").read_text(encoding="utf-8"))
    poor = json.loads((folder / "without" / "validation.json").read_text(encoding="utf-8"))
    tables = {p: read_table(folder / "images" / p / "images.csv") for p in PICTURED}
    blocks = {
        "conditions": table(*conditions(found)),
        "errors": table(*errors(found, poor)),
        "agreement": table(*agreement(found)),
        "pictures": table(*pictures(tables)),
        "ranks": table(*ranks(tables)),
    }
    write_blocks(DOCS / "validation.md", "docs/scripts/validation_tables.py", blocks)
    draw_series(folder / "market-drive", POLICIES, DOCS / "images" / "validation-series.png")
    draw_similarity(tables, DOCS / "images" / "validation-ssim.png")
    draw_pictures(folder / "images", tables, DOCS / "images" / "validation-pictures.png")


def main() -> None:
    """Measure, unless all is there, then write."""
    options = [argument for argument in sys.argv[1:] if argument.startswith("--")]
    folders = [Path(argument) for argument in sys.argv[1:] if not argument.startswith("--")]
    folder = folders[0] if folders else DOCS.parent / "out" / "validation"
    folder.mkdir(parents=True, exist_ok=True)
    if "--write" not in options:
        measure(folder)
    write(folder)
    if "--bundle" in options:
        shutil.copy(folder / "llvmpipe.parquet", LOG)
        lodbench("fit", "--bundled", "llvmpipe", "--out", f"{PROFILE}")


if __name__ == "__main__":
    main()
