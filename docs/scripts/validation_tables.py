"""Measure this machine, validate the simulator on it, and write what `validation.md` reports.

Usage: ``python docs/scripts/validation_tables.py [FOLDER]`` (part of ``make validation``), some
fifteen minutes on a quiet machine of two cores; logs and pages stay in FOLDER, by default
out/validation.  With ``--write`` tables are written from what is there, with ``--quick`` all is
small and the page is written to FOLDER, to try the script.  With ``--bundle`` the first log and its
fit also replace those of `llvmpipe` in the package.
"""

import json
import shutil
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from page_parts import table, write_blocks
from validation_figures import (
    draw_agreement,
    draw_pictures,
    draw_series,
    draw_similarity,
    read_table,
)
from validation_meshes import write_meshes

from lodbench.cli.main import run

HERE = Path(__file__).parent
DOCS = HERE.parent
PROFILE = DOCS.parent / "models" / "machine" / "profiles" / "llvmpipe.toml"
LOG = DOCS.parent / "analysis" / "fit" / "logs" / "llvmpipe.parquet"
CALIBRATED = (("plaza", "tour"), ("calibration-near", "tour"), ("calibration-dense", "tour"))
POLICIES = ("full", "static-screen", "feedback", "lodmanager", "gobbetti")
PICTURED = ("static-distance", "static-screen", "feedback", "lodmanager", "funkhouser", "gobbetti")
SHOWN = ("frame_ms_mean", "frame_ms_sd", "over_budget_time_fraction", "toggles_per_s")

Record: TypeAlias = dict[str, Any]
Rows: TypeAlias = Iterator[tuple[str, ...]]


@dataclass(frozen=True)
class Extent:
    """How much is measured."""

    size: str = "320x180"
    seconds: str = "4:6"
    warmup: str = "0.4"
    steps: str = "300"
    walk: str = "0:10"
    every: str = "80"
    replicates: str = "40"


QUICK = Extent("64x36", "0:1", "0.2", "40", "0:1", "20", "19")


def lodbench(*arguments: str) -> None:
    """Run a command, or stop where it fails; a policy that fails is no failure of the command."""
    print("lodbench", *arguments, flush=True)
    code = run(arguments)
    if code != 0 and not (arguments[0] == "validate" and code == 1):
        sys.exit(f"error: lodbench {arguments[0]} failed")


def measure(folder: Path, extent: Extent) -> None:
    """Calibrate on three scenes, validate on four others, and compare pictures along a walk."""
    # CPU time of the one thread that draws: what else runs on the machine is no part of it.
    quiet = ("--size", extent.size, "--clock", "thread", "--repeats", "1")
    profile = calibrate(folder, "quiet", quiet, extent)
    built = folder / "built.lodscene"
    files = map(str, write_meshes(folder))
    lodbench("scene", "build", *files, "--layout", "scatter", "--count", "75", "--out", f"{built}")
    shutil.copy(HERE / "validation.toml", folder)
    timed = ("--seconds", extent.seconds, "--warmup", extent.warmup)
    judged = (*timed, "--replicates", extent.replicates, "--hardware", f"{profile}")
    named = [word for policy in POLICIES for word in ("--policy", policy)]
    study = f"{folder / 'validation.toml'}"
    lodbench("validate", study, *quiet, *judged, *named, "--out", f"{folder / 'validation'}")
    measure_lag(folder, extent, timed)
    picture(folder, profile, extent)


def calibrate(folder: Path, name: str, drawing: tuple[str, ...], extent: Extent) -> Path:
    """Calibrate on three scenes in one go; return the profile."""
    logs = [folder / f"{name}-{scene}.parquet" for scene, _ in CALIBRATED]
    for log, (scene, trace) in zip(logs, CALIBRATED, strict=True):
        place = ("--scene", scene, "--trace", trace, "--steps", extent.steps)
        lodbench("record", "--calibrate", *place, *drawing, "--out", f"{log}")
    profile = folder / f"{name}.toml"
    fitted = ("--target", "frame_ms", "--terms", "auto", "--anyway", "--out", f"{profile}")
    lodbench("fit", *map(str, logs), *fitted)
    return profile


def measure_lag(folder: Path, extent: Extent, timed: tuple[str, ...]) -> None:
    """Calibrate with a thread that rasterises, and draw frames several deep on it."""
    drawing = ("--size", extent.size, "--threads", "1", "--repeats", "1")
    profile = calibrate(folder, "threaded", drawing, extent)
    judged = (*timed, "--replicates", extent.replicates, "--hardware", f"{profile}")
    study, out = f"{HERE / 'validation_lag.toml'}", f"{folder / 'lag'}"
    lodbench("validate", study, "--size", extent.size, *judged, "--passes", "1", "--out", out)


def picture(folder: Path, profile: Path, extent: Extent) -> None:
    """Compare pictures of each policy with full detail along a walk."""
    (folder / "images").mkdir(exist_ok=True)
    for policy in PICTURED:
        pictures = ("--images", f"{folder / 'images' / policy}", "--image-every", extent.every)
        walk = ("--scene", "market", "--trace", "walk", "--budget-ms", "5", "--size", extent.size)
        out = ("--repeats", "1", "--seconds", extent.walk, "--out", f"{folder / 'walk.parquet'}")
        lodbench("record", *walk, "--hardware", f"{profile}", "--policy", policy, *pictures, *out)


def conditions(found: Record) -> Rows:
    """Yield what was measured on what."""
    log = found["cases"][0]["log"]
    yield "", ""
    yield "renderer", f"{log['renderer']}, {log['driver']}"
    yield "processor", log["processor"]
    yield "date", log["date"]
    yield "picture", f"{log['resolution']}, drawn once a frame, clock {log['clock']}"
    yield "calibrated on", ", ".join(found["measured_on"])
    yield "validated on", ", ".join(dict.fromkeys(case["scene"] for case in found["cases"]))
    yield "replicates", f"{found['replicates']}, under {found['draws']} draws of the machine"


def answer(found: Record) -> str:
    """Return what the numbers come to, a sentence a line."""
    return "\n".join(f"- {sentence}" for sentence in found["answer"])


def cases(found: Record) -> Rows:
    """Yield what came of each path, and of all."""
    yield (
        *("path", "budget, ms", "model", "drift divided out", "recorded again, for what was drawn"),
        *("noise alone", "metrics inside", "Kendall's τ of `frame_ms_mean`"),
    )
    for case in found["cases"]:
        rank = case["ranks"].get("frame_ms_mean")
        yield (
            *(name_of(case), f"{case['budget_ms']:g}"),
            *error_cells(case["all_policies"], case["all_corrected"]),
            *(inside_text(case["inside"]), rank_text(rank)),
        )
    pooled = found["pooled"]
    yield (
        *("**all**", "", *error_cells(pooled["errors"], pooled["corrected"])),
        *(inside_text(pooled["inside"]), rank_text(pooled["ranks"].get("frame_ms_mean"))),
    )


def error_cells(errors: Record | None, corrected: Record | None) -> tuple[str, ...]:
    """Return errors raw and corrected, and the noise that they stand beside."""
    if errors is None:
        return ("–",) * 4
    best = corrected or errors
    noise = best["noise_pct"]
    return (
        plus_minus(errors["model"]),
        "–" if corrected is None else plus_minus(corrected["model"]),
        plus_minus(best["repeat"]),
        "–" if noise is None else f"{noise:.1f} (× {best['excess']:.2f})",
    )


def name_of(case: Record) -> str:
    """Return scene and path."""
    return f"{case['scene']}, {case['trace']}"


def plus_minus(error: Record | None) -> str:
    """Return mean and deviation, in per cent."""
    return "–" if error is None else f"{error['mean_pct']:+.1f} ± {error['sd_pct']:.1f}"


def inside_text(inside: Record) -> str:
    """Return how many metrics are inside."""
    if not inside["counted"]:
        return "–"
    return f"{inside['inside']} of {inside['counted']}, {inside['inside'] / inside['counted']:.0%}"


def rank_text(rank: Record | None) -> str:
    """Return τ, its interval and the pairs that count."""
    if rank is None or rank["simulated"] is None:
        return "–"
    span = f"{rank['low']:.2f} to {rank['high']:.2f}"
    return f"{rank['simulated']:.2f} ({span}), {rank['apart']} of {rank['pairs']} pairs"


def policies(found: Record) -> Rows:
    """Yield errors of each policy on each path, and how they go with the level of detail."""
    yield (
        *("path", "policy", "model", "model with v_time", "simulated replay", "recorded again"),
        *("noise alone", "from no detail to all", "quarters, the coarsest first"),
    )
    for case in found["cases"]:
        for policy in case["policies"]:
            errors, detail = policy["errors"], policy["detail"]
            slope = None if detail is None else detail["slope_pct"]
            quarters: list[float] = [] if detail is None else detail["quarters_pct"]
            compared = [errors[name] for name in ("model", "v_time", "simulation", "again")]
            yield (
                *(name_of(case), policy["label"], *map(plus_minus, compared)),
                *error_cells(errors, None)[3:],
                "–" if slope is None else f"{slope:+.0f}",
                ", ".join(f"{value:+.0f}" for value in quarters) or "–",
            )


def verdicts(found: Record) -> Rows:
    """Yield who keeps the budget and who is first, simulated and measured."""
    yield "path", "policy", "p99 measured, ms", "keeps the budget", "first or equal to it"
    for case in found["cases"]:
        for policy in case["policies"]:
            yield (
                *(name_of(case), policy["label"]),
                " and ".join(f"{ms:.3g}" for ms in policy["judged_ms"]),
                *(decision(policy[name]) for name in ("keeps_budget", "first")),
            )


def decision(item: Record) -> str:
    """Return what was decided and what was measured."""
    measured = {True: "yes", False: "no", None: "open"}[item["measured"]]
    wrong = " ✗" if item["as_measured"] is False else ""
    return f"{item['decided']} ({item['probability']:.0%}), measured {measured}{wrong}"


def metrics(found: Record) -> Rows:
    """Yield metrics measured, and simulated with their intervals."""
    yield "path", "policy", *(f"`{name}`" for name in SHOWN)
    for case in found["cases"]:
        for policy in case["policies"]:
            items = [policy["metrics"][name] for name in SHOWN]
            yield name_of(case), policy["label"], *map(agreement, items)


def agreement(item: Record) -> str:
    """Return a metric measured, again, and simulated."""
    texts = [f"{item[name]:.3g}" for name in ("measured", "again") if item[name] is not None]
    span = "" if item["low"] is None else f" ({item['low']:.3g} to {item['high']:.3g})"
    simulated = "–" if item["simulated"] is None else f"{item['simulated']:.3g}"
    return f"{' / '.join(texts) or '–'}; {simulated}{span}{' ✗' if item['inside'] is False else ''}"


def inside(found: Record) -> Rows:
    """Yield how many cells of each metric that counts are inside."""
    yield "metric", "inside", "share"
    for name, (count, of) in found["pooled"]["inside"]["by_metric"].items():
        yield f"`{name}`", f"{count} of {of}", f"{count / of:.0%}"


def lag(found: Record) -> Rows:
    """Yield lag and frame time of frames that were drawn several deep."""
    yield (
        "policy",
        "frames in flight",
        "lag, ms",
        "simulated",
        "off by",
        "frame time, ms",
        "simulated",
    )
    for case in found["cases"]:
        for policy in case["policies"]:
            lag_ms, frame_ms = (
                policy["metrics"][name] for name in ("lag_ms_mean", "frame_ms_mean")
            )
            off = 100.0 * (lag_ms["simulated"] / lag_ms["measured"] - 1.0)
            yield (
                *(policy["label"], str(case["frames_in_flight"])),
                f"{lag_ms['measured']:.3g}",
                f"{lag_ms['simulated']:.3g} ({lag_ms['low']:.3g} to {lag_ms['high']:.3g})",
                f"{off:+.0f} %",
                *(f"{frame_ms['measured']:.3g}", f"{frame_ms['simulated']:.3g}"),
            )


def pictures(tables: dict[str, dict[str, np.ndarray[Any, Any]]]) -> Rows:
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


def ranks(tables: dict[str, dict[str, np.ndarray[Any, Any]]]) -> Rows:
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


def write(folder: Path, page: Path, images: Path) -> None:
    """Write tables and figures from what was measured."""
    found, deep = (
        json.loads((folder / name / "validation.json").read_text(encoding="utf-8"))
        for name in ("validation", "lag")
    )
    tables = {p: read_table(folder / "images" / p / "images.csv") for p in PICTURED}
    blocks = {
        "conditions": table(*conditions(found)),
        "answer": answer(found),
        "cases": table(*cases(found)),
        "policies": table(*policies(found)),
        "verdicts": table(*verdicts(found)),
        "metrics": table(*metrics(found)),
        "inside": table(*inside(found)),
        "lag": table(*lag(deep)),
        "pictures": table(*pictures(tables)),
        "ranks": table(*ranks(tables)),
        "agreement": "![Metrics simulated, with their intervals, over measured ones]"
        "(images/validation-agreement.png)",
        "series": "![Frame times measured and simulated along a path]"
        "(images/validation-series.png)",
    }
    write_blocks(page, "docs/scripts/validation_tables.py", blocks)
    images.mkdir(exist_ok=True)
    draw_series(folder / "validation", found["cases"][0], images / "validation-series.png")
    draw_agreement(found, SHOWN, images / "validation-agreement.png")
    draw_similarity(tables, images / "validation-ssim.png")
    draw_pictures(folder / "images", tables, images / "validation-pictures.png")


def main() -> None:
    """Measure, unless all is there, then write."""
    options = [argument for argument in sys.argv[1:] if argument.startswith("--")]
    folders = [Path(argument) for argument in sys.argv[1:] if not argument.startswith("--")]
    folder = folders[0] if folders else DOCS.parent / "out" / "validation"
    folder.mkdir(parents=True, exist_ok=True)
    quick = "--quick" in options
    if "--write" not in options:
        measure(folder, QUICK if quick else Extent())
    page, images = DOCS / "validation.md", DOCS / "images"
    if quick:
        page, images = Path(shutil.copy(page, folder)), folder / "figures"
    write(folder, page, images)
    if "--bundle" in options:
        shutil.copy(folder / f"quiet-{CALIBRATED[0][0]}.parquet", LOG)
        lodbench("fit", "--bundled", "llvmpipe", "--out", f"{PROFILE}")


if __name__ == "__main__":
    main()
