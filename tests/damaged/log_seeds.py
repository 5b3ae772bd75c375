"""Logs of every format, of a few rows."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet
from seed import LINES, Seed, beginning, kind_of, one_file, wild_files

_INFO = ("log", "info", "@")
_PRESENTMON = (
    "Application,ProcessID,SwapChainAddress,PresentFlags,Dropped,TimeInSeconds,MsBetweenPresents,"
    "MsBetweenDisplayChange,MsInPresentAPI"
)
_PRESENTMON_2 = (
    "Application,ProcessID,SwapChainAddress,PresentRuntime,SyncInterval,PresentFlags,AllowsTearing,"
    "PresentMode,CPUStartTime,FrameTime,CPUBusy,CPUWait,GPULatency,GPUTime,GPUBusy,GPUWait,"
    "DisplayLatency,DisplayedTime"
)


def log_seeds(scratch: Path) -> Iterator[Seed]:
    """Yield a log of each format."""
    for name, lines in _texts().items():
        yield one_file("logs", name, "\n".join(lines) + "\n", "text", *_INFO)
    records = [
        {"gpu_ms": 8.0 + i % 5, "draw_calls": 100 + i, "triangles": 1e5 + 7 * i}
        for i in range(LINES)
    ]
    yield one_file("logs", "records.json", json.dumps(records), "json", *_INFO)
    yield one_file("logs", "lines.jsonl", "\n".join(map(json.dumps, records)), "text", *_INFO)
    times = {
        "TimeInSeconds": [0.016 * i for i in range(LINES)],
        "MsBetweenPresents": [16.6] * LINES,
        "MsInPresentAPI": [0.5] * LINES,
    }
    runs = {"Runs": [{"CaptureData": times}], "Info": {"GPU": "x"}, "Hash": "0"}
    yield one_file("logs", "capframex.json", json.dumps(runs), "json", *_INFO)
    n = np.arange(LINES)
    columns = {"frame_ms": 16.0 + n % 3, "gpu_ms": 8.0 + n % 5, "draw_calls": 100 + n}
    parquet.write_table(pa.table(columns), scratch / "log.parquet")
    yield one_file("logs", "log.parquet", (scratch / "log.parquet").read_bytes(), "parquet", *_INFO)
    for path in wild_files("logs"):
        kind, mapped = kind_of(path), "mapped" in path.name
        more = ("--map", "gpu_ms=time") if mapped else ()
        yield one_file("logs", path.name, beginning(path), kind, *_INFO, *more)


def _texts() -> dict[str, list[str]]:
    n = range(LINES)
    rows = [f"{16.6 + 0.1 * (i % 7):.3f},{8 + i % 5},{1000 + 10 * i},{200000 + i}" for i in n]
    unity = "CPU Main Thread Frame Time,GPU Frame Time,Draw Calls Count,Triangles Count"
    unreal = "EVENTS,FrameTime,GPUTime,RHI/DrawCalls,RHI/PrimitivesDrawn"
    mango = ["os,cpu,gpu,ram,kernel,driver,cpuscheduler", "a,b,c,1,2,3,4"]
    return {
        "columns.csv": ["frame_ms,gpu_ms,draw_calls,triangles", *rows],
        "unity.csv": [unity, *rows],
        "unreal.csv": [unreal, *(f",{row}" for row in rows), "[Platform],Windows"],
        "mangohud.csv": [*mango, "fps,frametime,cpu_load,gpu_load", *rows],
        "presentmon.csv": [
            _PRESENTMON,
            *(f"a.exe,7,0x1,0,0,{0.016 * i:.4f},16.{i % 10},16.{i % 9},0.{i % 4}" for i in n),
        ],
        "presentmon-2.csv": [
            _PRESENTMON_2,
            *(
                f"a.exe,7,0x1,DXGI,1,0,0,Hardware: Independent Flip,{16 * i},16.{i % 10},8,8,1,9,"
                f"9,1,30,16.6"
                for i in n
            ),
        ],
        "fraps.csv": ["Frame, Time (ms)", *(f"{i + 1},{16.6 * i:.3f}" for i in n)],
    }
