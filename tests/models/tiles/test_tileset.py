"""Tilesets as scenes: explicit, implicit, external, real ones, and hostile ones."""

import json
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench import InputError
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.models.scene.tree import Tree
from lodbench.models.tiles.tile_walk import MAX_TILES
from lodbench.models.tiles.tileset import read_tileset

BALL = {"sphere": [0, 0, 0, 10]}
BOX = {"box": [0, 0, 0, 8, 0, 0, 0, 8, 0, 0, 0, 4]}


def write(path: Path, root: dict[str, Any]) -> Path:
    """Write a tileset with this root."""
    path.parent.mkdir(parents=True, exist_ok=True)
    document = {"asset": {"version": "1.1"}, "geometricError": 500, "root": root}
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def tile(error: float | None = 1.0, **more: Any) -> dict[str, Any]:
    """Return a tile in a ball of 10 m."""
    return {"boundingVolume": BALL, **({} if error is None else {"geometricError": error}), **more}


def test_a_tree_by_hand(tmp_path: Path) -> None:
    """Parents, depths, errors, inherited refinement and a missing error, in document order."""
    leaf = tile(None)
    root = tile(8, refine="ADD", children=[tile(4, children=[leaf]), tile(2, refine="REPLACE")])
    scene, origin = read_tileset(write(tmp_path / "tileset.json", root))
    assert scene.name == tmp_path.name
    assert scene.parent.tolist() == [-1, 0, 1, 0]
    assert scene.additive.tolist() == [True, True, True, False]
    assert scene.types.levels.error_m.tolist() == [8.0, 4.0, 0.0, 2.0]
    assert scene.radius_m.tolist() == [10.0] * 4
    assert origin.options["errors_missing_read_as_0"] == 1


def test_transforms_add_up(tmp_path: Path) -> None:
    """A child twice as large, 5 m up in a parent that is moved by 100 m; errors scale along."""
    move = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 100, 0, 0, 1]
    grow = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 5, 1]
    root = tile(8, transform=move, children=[tile(3, transform=grow)])
    scene, _ = read_tileset(write(tmp_path / "tileset.json", root))
    assert scene.center_m.tolist() == [[100.0, 0.0, 0.0], [100.0, 0.0, 5.0]]
    assert scene.radius_m.tolist() == [10.0, 20.0]
    assert scene.types.levels.error_m.tolist() == [8.0, 6.0]


def test_external_tilesets_stand_below_their_tile(tmp_path: Path) -> None:
    """A tileset in a subfolder is a child of the tile that names it, its contents beside it."""
    (tmp_path / "part").mkdir()
    (tmp_path / "part" / "a.pnts").write_bytes(b"pnts")
    write(tmp_path / "part" / "inner.json", tile(2, content={"uri": "a.pnts"}))
    root = tile(8, content={"uri": "part/inner.json"}, children=[tile(1)])
    scene, origin = read_tileset(write(tmp_path / "tileset.json", root))
    assert sorted(scene.parent.tolist()) == [-1, 0, 0]
    assert origin.options["tilesets"] == 2
    assert origin.options["contents_of_other_formats"] == 1
    assert sorted(scene.types.levels.bytes.tolist()) == [0.0, 0.0, 4.0]


def subtree(tiles: str | int, content: int, children: str | int) -> bytes:
    """Return a binary subtree; availability is a constant, or bits from the lowest up."""
    document: dict[str, Any] = {"buffers": [], "bufferViews": []}
    binary = b""
    for name, value in (("tile", tiles), ("childSubtree", children)):
        if isinstance(value, int):
            document[f"{name}Availability"] = {"constant": value}
            continue
        packed = np.packbits([int(b) for b in value], bitorder="little").tobytes().ljust(8, b"\0")
        view = {"buffer": 0, "byteOffset": len(binary), "byteLength": len(packed)}
        document[f"{name}Availability"] = {"bitstream": len(document["bufferViews"])}
        document["bufferViews"].append(view)
        binary += packed
    document["contentAvailability"] = [{"constant": content}]
    document["buffers"] = [{"byteLength": len(binary)}] if binary else []
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 8)
    sizes = np.array([len(text), len(binary)], dtype="<u8").tobytes()
    return b"subt" + np.array([1], dtype="<u4").tobytes() + sizes + text + binary


def implicit(levels: int, per_subtree: int, scheme: str = "QUADTREE") -> dict[str, Any]:
    """Return the root of an implicit tree over a box of 16 by 16 by 8 m."""
    tiling = {
        "subdivisionScheme": scheme,
        "subtreeLevels": per_subtree,
        "availableLevels": levels,
        "subtrees": {"uri": "s-{level}-{x}-{y}.subtree"},
    }
    content = {"uri": "c/{level}/{x}/{y}.glb"}
    return {
        "boundingVolume": BOX,
        "geometricError": 32,
        "refine": "REPLACE",
        "implicitTiling": tiling,
        "content": content,
    }


def test_an_implicit_quadtree_by_hand(tmp_path: Path) -> None:
    """Root, two of its four children, and a subtree with one more tile below the second.

    Bits of two levels: root, then cells (0, 0), (1, 0), (0, 1), (1, 1); here (1, 0) and (0, 1).
    Child subtrees hang at level 2; of cell (0, 1), cell (1, 2) is there, the 10th in Morton order.
    """
    children = "".join("1" if i == 9 else "0" for i in range(16))
    (tmp_path / "s-0-0-0.subtree").write_bytes(subtree("10110", 1, children))
    (tmp_path / "s-2-1-2.subtree").write_bytes(subtree("10000", 1, 0))
    scene, origin = read_tileset(write(tmp_path / "tileset.json", implicit(3, 2)))
    assert scene.parent.tolist() == [-1, 0, 0, 2]
    assert scene.types.levels.error_m.tolist() == [32.0, 16.0, 16.0, 8.0]
    middle = [[0, 0, 0], [4, -4, 0], [-4, 4, 0], [-2, 2, 0]]
    assert scene.center_m.tolist() == middle
    assert scene.radius_m[3] == pytest.approx(np.sqrt(2**2 + 2**2 + 4**2))
    assert origin.options["contents_missing"] == 4


def test_an_implicit_octree_divides_heights(tmp_path: Path) -> None:
    """Nine tiles of a full octree of two levels; children tile the root's box."""
    (tmp_path / "s-0-0-0.subtree").write_bytes(subtree(1, 0, 0))
    scene, origin = read_tileset(write(tmp_path / "tileset.json", implicit(2, 2, "OCTREE")))
    assert len(scene) == 9
    assert sorted({z for _, _, z in scene.center_m.tolist()}) == [-2.0, 0.0, 2.0]
    assert scene.center_m[1:].mean(axis=0).tolist() == [0.0, 0.0, 0.0]
    assert origin.options["contents"] == 0


def nested(depth: int) -> str:
    """Return a document with tiles nested this deep."""
    ball = '{"boundingVolume":{"sphere":[0,0,0,1]},"children":['
    return '{"asset":{"version":"1.0"},"root":' + ball * depth + "]}" * depth + "}"


Files = dict[str, str | bytes]


def document(root: dict[str, Any]) -> str:
    """Return a tileset as text."""
    return json.dumps({"asset": {"version": "1.0"}, "root": root})


def one(text: str | bytes) -> Callable[[], Files]:
    """Return a case that is the tileset's file alone."""
    return lambda: {"tileset.json": text}


def linked(uri: str) -> Callable[[], Files]:
    """Return a case whose only content is this URI."""
    return one(document(tile(1, content={"uri": uri})))


def with_subtree(levels: int, per_subtree: int, data: bytes) -> Callable[[], Files]:
    """Return an implicit tree all of whose subtrees are the same file."""
    text = document(implicit(levels, per_subtree)).replace("s-{level}-{x}-{y}", "s")
    return lambda: {"tileset.json": text, "s.subtree": data}


def doubling() -> Files:
    """Return 40 tilesets, each of which holds the next one twice."""

    def pair(i: int) -> str:
        return document(tile(1, children=[tile(1, content={"uri": f"b{i}.json"})] * 2))

    files: Files = {f"b{i}.json": pair(i + 1) for i in range(40)}
    return files | {"tileset.json": pair(0)}


OUTSIDE = "inside the tileset's folder"
HOSTILE: dict[str, tuple[Callable[[], Files], str]] = {
    "a tileset inside itself": (linked("tileset.json"), "no cycle"),
    "two that hold each other": (
        lambda: linked("b.json")() | {"b.json": document(tile(1, content={"uri": "tileset.json"}))},
        "no cycle",
    ),
    "tilesets that double 40 times": (doubling, "at most"),
    "a path upwards": (linked("../secret.b3dm"), OUTSIDE),
    "a path upwards in disguise": (linked("a/%2e%2e/%2e%2e/x.json"), OUTSIDE),
    "an absolute path": (linked("/etc/passwd"), OUTSIDE),
    "a file URI": (linked("file:///etc/passwd"), OUTSIDE),
    "another host": (linked("//host/x.b3dm"), OUTSIDE),
    "subtrees of 4 million tiles": (one(document(implicit(20, 12))), "subtrees of at most"),
    "4^20 implied tiles": (with_subtree(20, 9, subtree(1, 1, 1)), "tiles, got more"),
    "4^30 implied tiles one by one": (with_subtree(30, 1, subtree(1, 1, 1)), "tiles, got more"),
    "2^40 levels": (one(document(implicit(2**40, 3))), "availableLevels"),
    "a subtree that is not there": (one(document(implicit(3, 2))), "file of that name"),
    "a damaged subtree": (with_subtree(3, 2, b"subt\x01\x00"), "subtree s.subtree"),
    "bits that are missing": (
        with_subtree(3, 2, subtree(1, 1, "1").replace(b'"byteLength": 8', b'"byteLength": 0')),
        "16 bits inside the file, got 0",
    ),
    "tiles 100,000 deep": (one(nested(100_000)), "nested"),
    "a sphere of 5 million numbers": (
        lambda: {"tileset.json": document(tile(1)).replace("10]", "1," * 5_000_000 + "1]")},
        "3D Tiles tileset",
    ),
    "too many tiles": (
        lambda: {"tileset.json": document(tile(1, children=[tile(1)] * (MAX_TILES + 1)))},
        "at most",
    ),
    "nothing": (one(""), "3D Tiles tileset"),
    "an array": (one("[1, 2]"), "3D Tiles tileset"),
    "bytes": (one(b"\x00\xff\xfe" * 100), "3D Tiles tileset"),
    "not UTF-8": (one(b'{"asset":{"version":"\xff"}}'), "3D Tiles tileset"),
    "a volume beyond all bounds": (
        one(document(tile(1)).replace("[0, 0, 0, 10]", "[1e300, 0, 0, 1e300]")),
        "within 1e9 m",
    ),
    "a negative error": (one(document(tile(-1))), "geometricError"),
    "an unknown refinement": (one(document(tile(1, refine="LATER"))), "ADD or REPLACE"),
    "a projective transform": (one(document(tile(1, transform=[1] * 16))), "affine"),
}


@pytest.mark.parametrize("case", HOSTILE)
def test_hostile_input_is_refused(case: str, tmp_path: Path) -> None:
    """One line, that names the file, within two seconds."""
    files, message = HOSTILE[case]
    folder = tmp_path / "inside"
    folder.mkdir()
    for name, text in files().items():
        (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    begin = time.process_time()
    with pytest.raises(InputError, match=message) as caught:
        read_tileset(folder / "tileset.json")
    assert time.process_time() - begin < 2.0
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith(str(folder))


def test_links_that_leave_the_folder_are_refused(tmp_path: Path) -> None:
    """A symbolic link is followed before it is judged."""
    (tmp_path / "secret.b3dm").write_bytes(b"b3dm")
    inside = tmp_path / "inside"
    path = write(inside / "tileset.json", tile(1, content={"uri": "link.b3dm"}))
    (inside / "link.b3dm").symlink_to(tmp_path / "secret.b3dm")
    with pytest.raises(InputError, match=OUTSIDE):
        read_tileset(path)


@pytest.mark.skipif(
    not Path("/proc/self/status").exists(), reason="reads Linux's account of memory"
)
@pytest.mark.parametrize("case", ["4^30 implied tiles one by one", "too many tiles"])
def test_hostile_input_takes_little_memory(case: str, tmp_path: Path) -> None:
    """A process of its own stays below 1 GB."""
    for name, text in HOSTILE[case][0]().items():
        (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    # Not getrusage: its peak is inherited from the process of the tests, which may have been large.
    script = (
        "import pathlib, re, sys\n"
        "from lodbench.cli.main import run\n"
        "code = run(['scene', 'info', sys.argv[1]])\n"
        "status = pathlib.Path('/proc/self/status').read_text()\n"
        "print(code, re.search(r'VmHWM:\\s*(\\d+)', status)[1])"
    )
    command = [sys.executable, "-c", script, str(tmp_path / "tileset.json")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    code, kibibytes = map(int, done.stdout.split())
    assert code == 2
    assert kibibytes < 1_000_000
    assert done.stderr.count("\n") == 1


def expected(root: dict[str, Any]) -> tuple[list[int], list[float], int]:
    """Return tiles by depth, errors in document order and contents, by another way."""
    depths: Counter[int] = Counter()
    errors: list[float] = []
    contents, stack = 0, [(root, 0)]
    while stack:
        here, depth = stack.pop()
        depths[depth] += 1
        errors.append(here.get("geometricError", 0.0))
        contents += ("content" in here) + len(here.get("contents", []))
        stack += [(child, depth + 1) for child in here.get("children", [])[::-1]]
    return [depths[d] for d in sorted(depths)], errors, contents


@pytest.mark.realdata
@pytest.mark.parametrize(
    "name",
    [
        "plateau-kumagaya.json",
        "discrete-lod/tileset.json",
        "granularities/tileset.json",
        "request-volume/tileset.json",
    ],
)
def test_real_tilesets_are_as_their_json_says(name: str, data_dir: Path) -> None:
    """Counts, depths and errors of every real tileset; children lie in their parent's sphere.

    The finest dragon is not there: the medium one has nothing below it.
    """
    path = data_dir / "tilesets" / name
    root = json.loads(path.read_text(encoding="utf-8"))["root"]
    depths, errors, contents = expected(root)
    scene, origin = read_tileset(path)
    left_out = int(name == "discrete-lod/tileset.json")
    assert origin.options["tiles"] == sum(depths)
    assert origin.options["tiles_left_out"] == left_out
    assert np.bincount(Tree(scene).depth).tolist() == depths[: len(depths) - left_out]
    matrix = np.array(root.get("transform", np.eye(4).ravel())).reshape(4, 4)
    scale = np.linalg.norm(matrix[0, :3])
    if name != "request-volume/tileset.json":  # transforms further down there, of leaves of error 0
        errors = [scale * error for error in errors[: len(scene)]]
    assert scene.types.levels.error_m == pytest.approx(errors)
    assert origin.options["contents"] == contents
    child = np.flatnonzero(scene.parent >= 0)
    gap = np.linalg.norm(scene.center_m[child] - scene.center_m[scene.parent[child]], axis=1)
    if name != "request-volume/tileset.json":  # whose inner volumes reach beyond the root's
        assert (gap < scene.radius_m[scene.parent[child]]).all()


@pytest.mark.realdata
def test_the_city_of_kumagaya(data_dir: Path) -> None:
    """2,435 tiles that add to each other, some 25 km wide, on the plane that touches the Earth."""
    scene, origin = read_tileset(data_dir / "tilesets" / "plateau-kumagaya.json")
    assert len(scene) == 2_435
    assert scene.additive.all()
    assert origin.options["errors_missing_read_as_0"] == 2_189
    assert np.abs(scene.center_m[:, :2]).max() < 13_000.0
    assert np.abs(scene.center_m[:, 2]).max() < 100.0


@pytest.mark.realdata
def test_contents_are_counted(data_dir: Path) -> None:
    """The dragons that are there are read; the one that is not never replaces another."""
    path = data_dir / "tilesets" / "discrete-lod" / "tileset.json"
    scene = load_scene(str(path))
    levels = scene.types.levels
    assert levels.counts[:, 2].tolist() == [2_312.0, 14_782.0]
    sizes = [(path.parent / f"dragon_{name}.b3dm").stat().st_size for name in ("low", "medium")]
    assert levels.bytes.tolist() == sizes
