"""Figures of `validation.md`, for `validation_tables.py`."""

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.study.comparison_folder import frame_log_names
from lodbench.analysis.validation.recording_folder import case_folders
from lodbench.sim.frame_log_file import read_frame_log

Table: TypeAlias = dict[str, NDArray[np.float64]]

COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#555555")
MEASURED, SIMULATED = "#D55E00", "#0072B2"
SHOWN = 0.62  # of the height: below the horizon there is no ground


def read_table(path: Path) -> Table:
    """Return the columns of an ``images.csv``."""
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def draw_series(folder: Path, case: dict[str, Any], path: Path) -> None:
    """Draw frame times of a case measured and simulated along the path, one panel a policy."""
    plt = _pyplot()
    labels = [policy["label"] for policy in case["policies"]]
    names = frame_log_names(labels)
    stem = case_folders([f"{case['scene']}-{case['trace']}"])[0]
    parts = {
        "simulated": (folder / "simulated" / stem, SIMULATED),
        "measured": (folder / "recordings" / stem / "measured", MEASURED),
    }
    figure, axes = plt.subplots(
        len(labels), 1, figsize=(8, 1.15 * len(labels)), sharex=True, squeeze=False
    )
    for axis, label in zip(axes[:, 0], labels, strict=True):
        for kind, (logs, color) in parts.items():
            run = MeasuredFrames(read_frame_log(logs / names[label]), *case["window_s"])
            axis.plot(run.time_s, run.work_ms, color=color, linewidth=0.7, label=kind)
        axis.axhline(case["budget_ms"], color="#888888", linewidth=0.7, linestyle="--")
        axis.set_ylim(bottom=0.0)
        axis.set_title(label, fontsize=8, loc="left", pad=2)
        axis.tick_params(labelsize=7)
    axes[0, 0].legend(fontsize=7, loc="upper right", ncols=2)
    axes[len(labels) // 2, 0].set_ylabel("frame time, ms", fontsize=8)
    axes[-1, 0].set_xlabel(f"time of the path, s ({case['scene']}, {case['trace']})", fontsize=8)
    _save(figure, path)


def draw_agreement(found: dict[str, Any], names: Sequence[str], path: Path) -> None:
    """Draw metrics simulated, with their intervals, over measured ones, a colour a scene."""
    plt = _pyplot()
    scenes = list(dict.fromkeys(case["scene"] for case in found["cases"]))
    figure, axes = plt.subplots(1, len(names), figsize=(2.6 * len(names), 2.9))
    for axis, name in zip(axes, names, strict=True):
        for case in found["cases"]:
            color = COLORS[scenes.index(case["scene"]) % len(COLORS)]
            for policy in case["policies"]:
                item = policy["metrics"][name]
                if None not in (item["measured"], item["low"]):
                    axis.plot([item["measured"]] * 2, [item["low"], item["high"]], color=color)
                    axis.plot(item["measured"], item["simulated"], ".", color=color)
        top = max(*axis.get_xlim(), *axis.get_ylim())
        axis.plot([0.0, top], [0.0, top], color="#888888", linewidth=0.7, linestyle="--")
        axis.set_title(name, fontsize=8)
        axis.tick_params(labelsize=7)
        axis.set_xlabel("measured", fontsize=8)
    axes[0].set_ylabel("simulated", fontsize=8)
    for scene, color in zip(scenes, COLORS, strict=False):
        axes[-1].plot([], [], color=color, label=scene)
    axes[-1].legend(fontsize=7)
    _save(figure, path)


def draw_similarity(tables: dict[str, Table], path: Path) -> None:
    """Draw what pictures show against what the simulator computes."""
    plt = _pyplot()
    figure, axes = plt.subplots(1, 2, figsize=(8, 3.2), sharey=True)
    for (policy, columns), color in zip(tables.items(), COLORS, strict=False):
        for axis, name in zip(axes, ("sse_px_p95", "benefit_share"), strict=True):
            x = columns[name] if name != "benefit_share" else 1.0 - columns[name]
            axis.scatter(x, 1.0 - columns["ssim"], s=12, color=color, label=policy, alpha=0.75)
    for axis, title in zip(axes, ("sse_px_p95, px", "1 − benefit share"), strict=True):
        axis.set_xlabel(title, fontsize=8)
        axis.tick_params(labelsize=7)
    axes[0].set_ylabel("1 − SSIM", fontsize=8)
    axes[1].legend(fontsize=7)
    _save(figure, path)


def draw_pictures(folder: Path, tables: dict[str, Table], path: Path) -> None:
    """Draw the worst picture of three policies: as drawn, in full detail, and the difference."""
    from PIL import Image

    worst = sorted(tables, key=lambda policy: float(tables[policy]["ssim"].min()))
    chosen = (worst[0], worst[len(worst) // 2], worst[-1])
    plt = _pyplot()
    figure, axes = plt.subplots(3, 3, figsize=(9, 3.9))
    for row, policy in zip(axes, chosen, strict=True):
        frame = int(tables[policy]["frame"][tables[policy]["ssim"].argmin()])
        picture = np.asarray(Image.open(folder / policy / f"frame-{frame:06}.png"))
        parts = np.split(picture[: int(SHOWN * len(picture))], 3, axis=1)
        for axis, part in zip(row, parts, strict=True):
            axis.imshow(part)
            axis.set_xticks([])
            axis.set_yticks([])
        row[0].set_ylabel(policy, fontsize=7)
    titles = ("as drawn", "in full detail", "difference, the darker the more")
    for axis, title in zip(axes[0], titles, strict=True):
        axis.set_title(title, fontsize=8)
    _save(figure, path)


def _pyplot() -> Any:
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    return plt


def _save(figure: Any, path: Path) -> None:
    figure.tight_layout()
    figure.savefig(path, dpi=130, metadata={"Software": None})
