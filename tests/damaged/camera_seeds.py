"""Camera traces of every format, of a few poses."""

import struct
from collections.abc import Iterator
from pathlib import Path

from seed import LINES, Seed, beginning, kind_of, one_file, test_module, wild_files

from lodbench.traces.cameras.generators.generate import generate
from lodbench.traces.cameras.write_trace import write_trace

_TIMED, _UNTIMED = ("trace", "info", "@"), ("trace", "info", "@", "--rate", "10")
_LINES_OF_TEXT = (
    *("colmap", "open3d-log", "matrices", "airsim"),
    *("unreal-view", "columns", "chan"),
)
_WILD_UNTIMED = ("3dgs", "colmap", "nerf-", "replica")
_EUROC = (
    "#timestamp,p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z [],"
    "v_RS_R_x [m s^-1],v_RS_R_y [m s^-1],v_RS_R_z [m s^-1]"
)
_LONGEST = 200_000


def camera_seeds(scratch: Path) -> Iterator[Seed]:
    """Yield a trace of each format."""
    circle = test_module("traces/cameras/formats/test_one_circle.py")
    for name, known, made, reading in circle.CASES:
        command = _UNTIMED if reading.rate_hz else _TIMED
        command += ("--frame", reading.frame) if reading.frame else ()
        text, kind = made(), "json"
        if known in _LINES_OF_TEXT:
            kind, text = "text", "\n".join(text.split("\n")[:LINES])
        file = f"f{Path(name).suffix}"
        yield one_file("cameras", f"{known}: {name}", text, kind, *command, file=file)
    trace = generate("walk", duration_s=2.0, rate_hz=20.0)
    for suffix, kind in ((".csv", "text"), (".parquet", "parquet"), (".txt", "text")):
        path = scratch / f"walk{suffix}"
        write_trace(trace, path, "tum" if suffix == ".txt" else None)
        yield one_file("cameras", path.name, path.read_bytes(), kind, *_TIMED)
    yield from _tables()
    for path in wild_files("cameras"):
        text = beginning(path)
        command = _UNTIMED if path.name.startswith(_WILD_UNTIMED) else _TIMED
        if len(text) < _LONGEST:
            yield one_file("cameras", path.name, text, kind_of(path), *command)


def _tables() -> Iterator[Seed]:
    n = range(LINES)
    rows = [f"{i * 50_000_000},{0.1 * i},0,1.6,1,0,0,0,0,0,0" for i in n]
    yield one_file("cameras", "euroc.csv", "\n".join([_EUROC, *rows]), "text", *_TIMED)
    poses = "\n".join(f"1 0 0 {0.1 * i} 0 1 0 1.6 0 0 1 0" for i in n).encode()
    times = "\n".join(f"{0.1 * i:e}" for i in n).encode()
    kinds = {"f.txt": "text", "times.txt": "text"}
    yield Seed("cameras", "kitti.txt", {"f.txt": poses, "times.txt": times}, kinds, _TIMED)
    head = "Participant,Dataset,ViewFrame,HMDPX,HMDPY,HMDPZ,HMDRX,HMDRY,HMDRZ"
    rows = [f"P1,H1,{i},{0.01 * i},1.6,0,0,{i},0" for i in n]
    yield one_file("cameras", "headset.csv", "\n".join([head, *rows]), "text", *_TIMED)
    records = [struct.pack("<Q", LINES)]
    for i in n:
        points = struct.pack("<Q", i % 2) + bytes(24 * (i % 2))
        records.append(struct.pack("<i7di", i, 1, 0, 0, 0, 0.1 * i, 0, 0, 1) + b"a.jpg\0" + points)
    data = b"".join(records)
    yield one_file("cameras", "colmap.bin", data, "bytes", *_UNTIMED, file="images.bin")
