"""Small whole files of every format that is read, and how each is read: what is to be damaged.

They are made here, or by the tests that know their truth, or taken from the real data where these
are at hand.
"""

import base64
import importlib.util
import json
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from lodbench.analysis.gate.baseline import Baseline, Case, Entry, read_baseline, write_baseline
from lodbench.analysis.gate.limits_file import DEFAULT_LIMITS, read_limits
from lodbench.analysis.gate.measurements import Conditions
from lodbench.analysis.fit.sampling.chain_file import load_chain, save_chain
from lodbench.analysis.study.sweep.study_file import read_study
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.sim.frame_log_file import read_frame_log, write_frame_log
from lodbench.traces.cameras.generators.generate import generate
from lodbench.traces.cameras.write_trace import write_trace

ROOT = Path(__file__).parents[2]
LINES = 40
"""Rows of a text that is damaged: real ones are cut, as damage in the 9,000th is that in the 9th."""

_CONDITIONS = Conditions(
    hardware="here",
    display="vsync",
    refresh_hz=60.0,
    frames_in_flight=2,
    pacing="none",
    latency_limit=0,
    budget_ms=4.0,
    seed=0,
    seeds=2,
    warmup_s=1.0,
    visible_px=1.0,
)


@dataclass(frozen=True, slots=True)
class Seed:
    """A file, or a folder of files.

    Attributes
    ----------
    family, name : str
        What its results are gathered under, and its own.
    files : dict of str to bytes
        By name; the first is the one that is read.
    kinds : dict of str to str
        How each that is damaged is known (`damage.KINDS`).
    command : tuple of str
        The command line, ``@`` for the file; or the name of a reader in `READERS`.
    """

    family: str
    name: str
    files: dict[str, bytes]
    kinds: dict[str, str]
    command: tuple[str, ...]


READERS: dict[str, Callable[[Path], object]] = {
    "hardware": lambda path: load_hardware(str(path)),
    "study": read_study,
    "limits": read_limits,
    "baseline": lambda path: read_baseline(path, _CONDITIONS),
    "frame log": read_frame_log,
    "chain": lambda path: load_chain(path, "of this"),
}
"""What is read by no command of its own, or by one that works for long."""


def make_seeds(scratch: Path) -> list[Seed]:
    """Return all seeds, made in an empty folder."""
    makers = (_logs, _wild_logs, _cameras, _wild_cameras, _meshes, _scenes, _tilesets)
    return [seed for make in (*makers, _placements, _others) for seed in make(scratch)]


def _one(
    family: str, name: str, content: bytes | str, kind: str, *command: str, suffix: str = ""
) -> Seed:
    data = content.encode() if isinstance(content, str) else content
    file = f"f{suffix or Path(name).suffix}"
    return Seed(family, name, {file: data}, {file: kind}, command)


def _module(path: Path) -> Any:
    """Return a test file as a module: its makers know the formats."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _wild() -> Path | None:
    named = os.environ.get("LODBENCH_DATA")
    folder = (Path(named) if named else ROOT.parent / "shared" / "data") / "wild"
    return folder if folder.is_dir() else None


def _cut(path: Path) -> str:
    """Return the beginning of a text."""
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = [line for line, _ in zip(file, range(LINES), strict=False)]
    return "".join(lines)


def _kind_of(path: Path) -> str:
    suffix = path.suffix.lower()
    return {".json": "json", ".gltf": "json", ".glb": "glb", ".parquet": "parquet"}.get(
        suffix, "text"
    )


def _logs(scratch: Path) -> Iterator[Seed]:
    info = ("log", "info", "@")
    n = np.arange(LINES)
    rows = [f"{16.6 + 0.1 * (i % 7):.3f},{8 + i % 5},{1000 + 10 * i},{200000 + i}" for i in n]
    texts = {
        "columns.csv": ["frame_ms,gpu_ms,draw_calls,triangles", *rows],
        "unity.csv": [
            "CPU Main Thread Frame Time,GPU Frame Time,Draw Calls Count,Triangles Count",
            *rows,
        ],
        "unreal.csv": [
            "EVENTS,FrameTime,GPUTime,RHI/DrawCalls",
            *(f",{row}" for row in rows),
            "[Platform],Windows",
        ],
        "mangohud.csv": [
            "os,cpu,gpu,ram,kernel,driver,cpuscheduler",
            "a,b,c,1,2,3,4",
            "fps,frametime,cpu_load,gpu_load",
            *(f"60,{row}" for row in rows),
        ],
        "presentmon.csv": [
            "Application,ProcessID,SwapChainAddress,PresentFlags,Dropped,TimeInSeconds,MsBetweenPresents,MsBetweenDisplayChange,MsInPresentAPI",
            *(f"a.exe,7,0x1,0,0,{0.016 * i:.4f},16.{i % 10},16.{i % 9},0.{i % 4}" for i in n),
        ],
        "presentmon-2.csv": [
            "Application,ProcessID,SwapChainAddress,PresentRuntime,SyncInterval,PresentFlags,AllowsTearing,PresentMode,CPUStartTime,FrameTime,CPUBusy,CPUWait,GPULatency,GPUTime,GPUBusy,GPUWait,DisplayLatency,DisplayedTime",
            *(
                f"a.exe,7,0x1,DXGI,1,0,0,Hardware: Independent Flip,{16 * i},16.{i % 10},8,8,1,9,9,1,30,16.6"
                for i in n
            ),
        ],
        "fraps.csv": ["Frame, Time (ms)", *(f"{i + 1},{16.6 * i:.3f}" for i in n)],
    }
    for name, lines in texts.items():
        yield _one("logs", name, "\n".join(lines) + "\n", "text", *info)
    records = [
        {"gpu_ms": 8.0 + i % 5, "draw_calls": 100 + i, "triangles": 1e5} for i in range(LINES)
    ]
    yield _one("logs", "records.json", json.dumps(records), "json", *info)
    yield _one("logs", "lines.jsonl", "\n".join(map(json.dumps, records)), "text", *info)
    runs = {
        "Runs": [
            {
                "CaptureData": {
                    "TimeInSeconds": [0.016 * i for i in range(LINES)],
                    "MsBetweenPresents": [16.6] * LINES,
                    "MsInPresentAPI": [0.5] * LINES,
                }
            }
        ],
        "Info": {"GPU": "x"},
        "Hash": "0",
    }
    yield _one("logs", "capframex.json", json.dumps(runs), "json", *info)
    import pyarrow as pa
    from pyarrow import parquet

    table = {
        "frame_ms": 16.0 + n % 3,
        "gpu_ms": 8.0 + n % 5,
        "draw_calls": 100 + n,
        "triangles": 1e5 + n,
    }
    parquet.write_table(pa.table(table), scratch / "log.parquet")
    yield _one("logs", "log.parquet", (scratch / "log.parquet").read_bytes(), "parquet", *info)


def _wild_logs(_: Path) -> Iterator[Seed]:
    wild = _wild()
    for path in sorted((wild / "logs").iterdir()) if wild else ():
        kind = _kind_of(path)
        content = path.read_text() if kind == "json" else _cut(path)
        yield _one("logs", path.name, content, kind, "log", "info", "@")


def _cameras(scratch: Path) -> Iterator[Seed]:
    timed, untimed = ("trace", "info", "@"), ("trace", "info", "@", "--rate", "10")
    circle = _module(ROOT / "tests" / "traces" / "cameras" / "formats" / "test_one_circle.py")
    for name, known, made, reading in circle.CASES:
        text = made()
        if known in {
            "colmap",
            "open3d-log",
            "matrices",
            "airsim",
            "unreal-view",
            "columns",
            "chan",
        }:
            kind, text = "text", "\n".join(text.split("\n")[:LINES])
        else:
            kind = "json"
        frame = ("--frame", reading.frame) if reading.frame else ()
        yield _one(
            "cameras",
            f"{known}: {name}",
            text,
            kind,
            *(untimed if reading.rate_hz else timed),
            *frame,
            suffix=Path(name).suffix,
        )
    trace = generate("walk", duration_s=2.0, rate_hz=20.0)
    for suffix, kind in ((".csv", "text"), (".parquet", "parquet"), (".txt", "text")):
        path = scratch / f"walk{suffix}"
        write_trace(trace, path, "tum" if suffix == ".txt" else None)
        yield _one("cameras", path.name, path.read_bytes(), kind, *timed)
    n = range(LINES)
    rows = [f"{i * 50_000_000},{0.1 * i},0,1.6,1,0,0,0,0,0,0" for i in n]
    head = (
        "#timestamp,p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []"
    )
    yield _one("cameras", "euroc.csv", "\n".join([head, *rows]), "text", *timed)
    rows = [f"1 0 0 {0.1 * i} 0 1 0 1.6 0 0 1 0" for i in n]
    yield _one("cameras", "kitti.txt", "\n".join(rows), "text", *untimed)
    head = "Participant,Dataset,ViewFrame,HMDPX,HMDPY,HMDPZ,HMDRX,HMDRY,HMDRZ"
    rows = [f"P1,H1,{i},{0.01 * i},1.6,0,0,{i},0" for i in n]
    yield _one("cameras", "headset.csv", "\n".join([head, *rows]), "text", *timed)
    import struct

    records = [
        struct.pack("<i7di", i, 1, 0, 0, 0, 0.1 * i, 0, 0, 1)
        + b"a.jpg\0"
        + struct.pack("<Q", i % 2)
        + bytes(24 * (i % 2))
        for i in n
    ]
    yield _one(
        "cameras", "colmap.bin", struct.pack("<Q", LINES) + b"".join(records), "bytes", *untimed
    )


def _wild_cameras(_: Path) -> Iterator[Seed]:
    wild = _wild()
    for path in sorted((wild / "cameras").iterdir()) if wild else ():
        kind = _kind_of(path)
        text = path.read_text() if kind == "json" else _cut(path)
        if len(text) < 200_000:
            yield _one("cameras", path.name, text, kind, "trace", "info", "@", "--rate", "10")


def _meshes(_: Path) -> Iterator[Seed]:
    ball: Any = trimesh.creation.icosphere(subdivisions=1)
    build = (
        "scene",
        "build",
        "@",
        "--out",
        "out.lodscene",
        "--count",
        "3",
        "--levels",
        "2",
        "--min-triangles",
        "8",
    )
    for suffix, kind, options in (
        ("obj", "text", {}),
        ("off", "text", {}),
        ("ply", "bytes", {}),
        ("ply", "text", {"encoding": "ascii"}),
        ("stl", "bytes", {}),
        ("stl_ascii", "text", {}),
        ("glb", "glb", {}),
    ):
        data: Any = ball.export(file_type=suffix, **options)
        name = f"ball{'-ascii' if kind == 'text' else ''}.{suffix.removesuffix('_ascii')}"
        yield _one("meshes", name, data, kind, *build)


def _gltf(points: Any, faces: Any, levels: int) -> tuple[dict[str, Any], bytes]:
    """Return a document of an object whose levels are so many balls, and its binary."""
    positions, corners = np.asarray(points, "<f4").tobytes(), np.asarray(faces, "<u4").tobytes()
    nodes: list[dict[str, Any]] = [{"mesh": 0, "translation": [0, i, 0]} for i in range(levels)]
    if levels > 1:
        nodes[0]["extensions"] = {"MSFT_lod": {"ids": list(range(1, levels))}}
    shares = [len(faces) // 2**i * 3 for i in range(levels)]
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [node | {"mesh": i} for i, node in enumerate(nodes)],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1 + i, "material": 0}]}
            for i in range(levels)
        ],
        "buffers": [{"byteLength": len(positions) + len(corners)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(positions)},
            {"buffer": 0, "byteOffset": len(positions), "byteLength": len(corners)},
        ],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": len(points),
                "type": "VEC3",
                "min": [-1, -1, -1],
                "max": [1, 1, 1],
            },
            *(
                {"bufferView": 1, "componentType": 5125, "count": share, "type": "SCALAR"}
                for share in shares
            ),
        ],
    }
    return document, positions + corners


def _glb(document: dict[str, Any], binary: bytes) -> bytes:
    import struct

    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def _scenes(scratch: Path) -> Iterator[Seed]:
    from lodbench.cli.main import run

    info = ("scene", "info", "@")
    ball: Any = trimesh.creation.icosphere(subdivisions=1)
    mesh = scratch / "ball.obj"
    mesh.write_text(ball.export(file_type="obj"))
    for name, more in (("chain", ()), ("knots", ("--continuous",))):
        built = scratch / f"{name}.lodscene"
        status = run(
            [
                "scene",
                "build",
                str(mesh),
                "--out",
                str(built),
                "--count",
                "4",
                "--levels",
                "2",
                "--min-triangles",
                "8",
                "--json",
                *more,
            ]
        )
        assert status == 0
        yield _one("scenes", built.name, built.read_bytes(), "archive", *info)
    built = scratch / "tree.lodscene"
    assert (
        run(
            [
                "scene",
                "build-hlod",
                str(mesh),
                "--out",
                str(built),
                "--desired-triangles",
                "20",
                "--json",
            ]
        )
        == 0
    )
    yield _one("scenes", built.name, built.read_bytes(), "archive", *info)
    document, binary = _gltf(ball.vertices, ball.faces, 3)
    yield _one("scenes", "levels.glb", _glb(document, binary), "glb", *info)
    document["accessors"][0]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": 1, "componentType": 5125},
        "values": {"bufferView": 0},
    }
    document["buffers"][0]["uri"] = (
        "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    )
    yield _one("scenes", "sparse.gltf", json.dumps(document), "json", *info)
    del document["buffers"][0]["uri"]
    document["buffers"][0]["uri"] = "absent.bin"
    yield _one(
        "scenes",
        "no-buffer.gltf",
        json.dumps(_gltf(ball.vertices, ball.faces, 1)[0] | {"buffers": document["buffers"]}),
        "json",
        *info,
    )
    wild = _wild()
    for name in ("BoxDraco.gltf", "draco-and-plain.gltf", "BoxMeshopt.glb") if wild else ():
        assert wild is not None
        path = wild / "scenes" / name
        yield _one("scenes", name, path.read_bytes(), _kind_of(path), *info)


def _tilesets(_: Path) -> Iterator[Seed]:
    info = ("scene", "info", "@")
    tiles = _module(ROOT / "tests" / "models" / "tiles" / "test_tile_content.py")
    sets = _module(ROOT / "tests" / "models" / "tiles" / "test_tileset.py")
    region = {"region": [0.1, 0.5, 0.11, 0.51, 0.0, 100.0]}
    move = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 100, 0, 0, 1]
    leaves = [
        {**sets.tile(2.0), "content": {"uri": "a.b3dm"}},
        {**sets.tile(1.0), "content": {"uri": "b.i3dm"}, "transform": move},
        {**sets.tile(None), "contents": [{"uri": "c.cmpt"}, {"uri": "absent.glb"}]},
        {"boundingVolume": region, "geometricError": 1.0, "content": {"uri": "d.json"}},
    ]
    inner = {"asset": {"version": "1.1"}, "geometricError": 5, "root": sets.tile(1.0)}
    document = {
        "asset": {"version": "1.1"},
        "geometricError": 500,
        "root": sets.tile(16.0, refine="ADD", content={"uri": "m.glb"}, children=leaves),
    }
    parts = {
        "a.b3dm": tiles.tile(b"b3dm", {"BATCH_LENGTH": 0}, tiles.glb()),
        "b.i3dm": tiles.instanced(tiles.glb(), 1),
    }
    parts["c.cmpt"] = tiles.composite(parts["a.b3dm"], parts["b.i3dm"])
    files = {
        "tileset.json": json.dumps(document).encode(),
        "m.glb": tiles.glb(),
        **parts,
        "d.json": json.dumps(inner).encode(),
    }
    kinds = {
        name: {"json": "json", "glb": "glb"}.get(name.rpartition(".")[2], "tile") for name in files
    }
    yield Seed("tilesets", "explicit", files, kinds, info)
    for scheme in ("QUADTREE", "OCTREE"):
        root = sets.implicit(3, 3, scheme)
        document = {"asset": {"version": "1.1"}, "geometricError": 500, "root": root}
        files = {
            "tileset.json": json.dumps(document).encode(),
            "s-0-0-0.subtree": sets.subtree("1" * 21, 0, 0)
            if scheme == "QUADTREE"
            else sets.subtree(1, 0, 0),
        }
        yield Seed(
            "tilesets",
            f"implicit {scheme.lower()}",
            files,
            {"tileset.json": "json", "s-0-0-0.subtree": "tile"},
            info,
        )


def _placements(_: Path) -> Iterator[Seed]:
    ball: Any = trimesh.creation.box()
    mesh = ball.export(file_type="obj").encode()
    command = (
        "scene",
        "build",
        "box.obj",
        "--placements",
        "@",
        "--out",
        "out.lodscene",
        "--levels",
        "1",
    )
    rows = [f"box,{i},{i % 3},0,0,0,0,1,{1 + 0.1 * i},1" for i in range(12)]
    text = "\n".join(["type,x,y,z,qx,qy,qz,qw,scale,importance", *rows]).encode()
    yield Seed(
        "placements",
        "places.csv",
        {"places.csv": text, "box.obj": mesh},
        {"places.csv": "text"},
        command,
    )
    records = [
        {"type": "box", "position": [i, 0, 0], "rotation": [0, 0, 0, 1], "scale": 1.0}
        for i in range(12)
    ]
    text = json.dumps({"instances": records}).encode()
    yield Seed(
        "placements",
        "places.json",
        {"places.json": text, "box.obj": mesh},
        {"places.json": "json"},
        command,
    )


def _others(scratch: Path) -> Iterator[Seed]:
    profiles = ROOT / "models" / "machine" / "profiles"
    for name in ("desktop-assumed.toml", "quadro5000-2011.toml"):
        yield _one("hardware profiles", name, (profiles / name).read_bytes(), "text", "hardware")
    study = (ROOT / "docs" / "examples" / "sweeps" / "budgets.toml").read_text()
    yield _one("studies", "budgets.toml", 'scenes = ["plaza"]\n' + study, "text", "study")
    scoped = '[[for]]\nscene = "c*"\n[for.limits]\nvisible_pops_per_s = { max = 3, population = "such-paths" }\n'
    yield _one("limits", "limits.toml", DEFAULT_LIMITS + scoped, "text", "limits")
    entries = [Entry(f"path-{i}", "0a", {"work_ms_p99": [3.0, 3.1 + i]}) for i in range(3)]
    write_baseline(
        scratch / "baseline.json", Baseline(_CONDITIONS, [Case("full", "cows", entries)])
    )
    yield _one(
        "baselines", "baseline.json", (scratch / "baseline.json").read_bytes(), "json", "baseline"
    )
    import emcee

    backend: Any = emcee.backends.Backend()
    sampler: Any = emcee.EnsembleSampler(8, 2, lambda x: -0.5 * float(x @ x), backend=backend)
    sampler.run_mcmc(np.random.default_rng(0).normal(size=(8, 2)), 5)
    save_chain(backend, scratch / "chain.npz", "of this")
    yield _one("chains", "chain.npz", (scratch / "chain.npz").read_bytes(), "archive", "chain")
    import lodbench

    log = lodbench.replay(
        "full", "cows", generate("orbit", duration_s=0.5), "desktop-assumed", budget_ms=8.0
    )
    write_frame_log(scratch / "log.parquet", log)
    yield _one(
        "frame logs",
        "frames.parquet",
        (scratch / "log.parquet").read_bytes(),
        "parquet",
        "frame log",
    )
