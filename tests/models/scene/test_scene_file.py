"""Scene files: round trips, equal bytes, and files that are refused quickly."""

import io
import json
import time
import zipfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench import InputError
from lodbench.models.meshes.geometry import Geometry, LevelMesh
from lodbench.models.scene.motion import Motion
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_file import (
    SceneOrigin,
    read_geometry,
    read_origin,
    read_scene,
    write_scene,
)

Members = dict[str, bytes]


@pytest.fixture
def moving(ball_scene: tuple[Scene, Geometry]) -> tuple[Scene, Geometry]:
    """Return the small scene with two moving nodes."""
    motion = Motion(
        np.array([1, 4], dtype=np.int32), np.ones(2), np.array([0.5, -1.0]), np.zeros(2)
    )
    return replace(ball_scene[0], motion=motion), ball_scene[1]


@pytest.fixture
def members(moving: tuple[Scene, Geometry], tmp_path: Path) -> Members:
    """Return the members of a good file, by name."""
    path = tmp_path / "good.lodscene"
    write_scene(path, *moving)
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def pack(path: Path, members: Members, method: int = zipfile.ZIP_STORED) -> Path:
    """Write members as a zip file."""
    with zipfile.ZipFile(path, "w", method) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
    return path


def npy(values: Any) -> bytes:
    """Return the bytes of an array file."""
    buffer = io.BytesIO()
    np.save(buffer, np.asarray(values))
    return buffer.getvalue()


def array(data: bytes) -> np.ndarray:
    """Return the array in the bytes of an array file."""
    return np.load(io.BytesIO(data)).copy()


def same(one: Any, two: Any) -> bool:
    """Whether two frozen records hold equal arrays."""
    return all(
        np.array_equal(getattr(one, name), getattr(two, name))
        for name in one.__dataclass_fields__
        if isinstance(getattr(one, name), np.ndarray)
    )


def test_round_trip(moving: tuple[Scene, Geometry], tmp_path: Path) -> None:
    """Scene, types, levels, motion, geometry and origin come back as they were."""
    path = tmp_path / "a.lodscene"
    origin = SceneOrigin("lodbench 1", ("ball.obj",), {"seed": 3, "side_m": None, "up": "y"})
    write_scene(path, *moving, origin)
    scene, (written, geometry) = read_scene(path), moving
    assert scene.name == written.name
    assert scene.types.names == written.types.names
    assert same(scene, written)
    assert same(scene.types, written.types)
    assert same(scene.types.levels, written.types.levels)
    assert same(scene.motion, written.motion)
    again = read_geometry(path)
    assert len(again) == len(geometry)
    assert all(same(a, b) for a, b in zip(again, geometry, strict=True))
    assert [mesh.uv is None for mesh in again] == [False] * 3 + [True] * 2
    assert read_origin(path) == origin


def test_what_was_measured_of_types_comes_back(
    ball_scene: tuple[Scene, Geometry], tmp_path: Path
) -> None:
    """Surfaces and normals do, and files of before have none."""
    scene, geometry = ball_scene
    kinds = len(scene.types.names)
    normal = np.tile((0.0, 0.6, 0.8), (kinds, 1))
    types = replace(scene.types, surface_m2=np.arange(1.0, kinds + 1.0), normal=normal)
    path = tmp_path / "a.lodscene"
    write_scene(path, replace(scene, types=types), geometry)
    assert same(read_scene(path).types, types)
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(tmp_path / "old.lodscene", "w") as new:
        for item in old.infolist():
            if item.filename not in ("types/surface_m2.npy", "types/normal.npy"):
                new.writestr(item, old.read(item))
    before = read_scene(tmp_path / "old.lodscene").types
    assert not before.surface_m2.any()
    assert before.normal.shape == (kinds, 3)


def test_a_still_scene_has_no_motion(ball_scene: tuple[Scene, Geometry], tmp_path: Path) -> None:
    """What was not there does not appear."""
    write_scene(tmp_path / "a.lodscene", *ball_scene)
    assert read_scene(tmp_path / "a.lodscene").motion is None


def test_equal_scenes_give_equal_bytes(
    moving: tuple[Scene, Geometry], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No clock, no name of a folder and no order of memory reaches the file."""
    (tmp_path / "sub").mkdir()
    one, two = tmp_path / "a.lodscene", tmp_path / "sub" / "b.lodscene"
    write_scene(one, *moving)
    monkeypatch.setattr(time, "time", lambda: 2e9)
    write_scene(two, replace(moving[0]), tuple(replace(mesh) for mesh in moving[1]))
    assert one.read_bytes() == two.read_bytes()


def test_geometry_has_to_match(ball_scene: tuple[Scene, Geometry], tmp_path: Path) -> None:
    """A mesh too few is refused before a file is there."""
    with pytest.raises(InputError, match="expected 5 meshes as levels, got 4"):
        write_scene(tmp_path / "a.lodscene", ball_scene[0], ball_scene[1][:-1])
    assert list(tmp_path.iterdir()) == []


def test_a_failed_write_leaves_the_old_file(
    ball_scene: tuple[Scene, Geometry], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An interrupt while writing keeps what was there, and no temporary file."""
    path = tmp_path / "a.lodscene"
    path.write_text("old")

    def interrupt(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(np.lib.format, "write_array", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_scene(path, *ball_scene)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_predictors_that_a_file_lacks_are_zero(members: Members, tmp_path: Path) -> None:
    """Columns go by name: a file without splats, in another order, reads the same."""
    header = json.loads(members["scene.json"])
    kept = [name for name in reversed(header["predictors"]) if name != "splats"]
    counts = array(members["levels/counts.npy"])
    columns = [header["predictors"].index(name) for name in kept]
    changed = members | {
        "scene.json": json.dumps(header | {"predictors": kept}).encode(),
        "levels/counts.npy": npy(np.ascontiguousarray(counts[:, columns])),
    }
    scene = read_scene(pack(tmp_path / "a.lodscene", changed))
    assert np.array_equal(scene.types.levels.counts, counts)


def header_with(**changes: Any) -> Callable[[Members], Members]:
    """Return a change of the header."""

    def change(members: Members) -> Members:
        header = json.loads(members["scene.json"]) | changes
        return members | {"scene.json": json.dumps(header).encode()}

    return change


def array_with(name: str, change: Callable[[np.ndarray], Any]) -> Callable[[Members], Members]:
    """Return a change of one array."""
    key = f"{name}.npy"
    return lambda members: members | {key: npy(change(array(members[key])))}


def put(values: np.ndarray, index: Any, value: Any) -> np.ndarray:
    """Return the array with one value set."""
    values[index] = value
    return values


SCENE_DAMAGE: dict[str, tuple[Callable[[Members], Members], str]] = {
    "no header": (lambda m: {k: v for k, v in m.items() if k != "scene.json"}, "scene.json"),
    "no json": (lambda m: m | {"scene.json": b"\xff{"}, "expected a header"),
    "deep json": (lambda m: m | {"scene.json": b"[" * 100_000}, "expected a header"),
    "other schema": (header_with(schema="lodbench.scene/2"), "lodbench.scene/1"),
    "no schema": (header_with(schema=None), "expected a header"),
    "types of another type": (header_with(types=[1, 2]), "expected a header"),
    "types too few": (header_with(types=["ball"]), "type center_m"),
    "unknown predictor": (header_with(predictors=["pixels"]), "predictors"),
    "predictor twice": (header_with(predictors=["triangles"] * 7), "predictors"),
    "counts too narrow": (array_with("levels/counts", lambda a: a[:, :3].copy()), "columns"),
    "no array": (
        lambda m: {k: v for k, v in m.items() if k != "nodes/scale.npy"},
        "nodes/scale.npy",
    ),
    "half of the motion": (
        lambda m: {k: v for k, v in m.items() if k != "motion/radius_m.npy"},
        "motion/radius_m.npy",
    ),
    "short array": (array_with("nodes/scale", lambda a: a[:-1]), "node scale"),
    "other dtype": (array_with("nodes/scale", lambda a: a.astype(np.float32)), "float64"),
    "other order": (array_with("nodes/position_m", np.asfortranarray), "nodes/position_m"),
    "big-endian": (array_with("nodes/scale", lambda a: a.astype(">f8")), "nodes/scale"),
    "other dimensions": (array_with("nodes/scale", lambda a: a[:, None]), "nodes/scale"),
    "objects": (array_with("nodes/scale", lambda a: a.astype(object)), "nodes/scale"),
    "no nodes": (array_with("nodes/type_index", lambda a: a[:0]), "node position_m"),
    "type out of range": (array_with("nodes/type_index", lambda a: put(a, 0, 2)), "type_index"),
    "type below range": (array_with("nodes/type_index", lambda a: put(a, 0, -1)), "type_index"),
    "NaN position": (array_with("nodes/position_m", lambda a: put(a, (3, 1), np.nan)), "finite"),
    "huge position": (array_with("nodes/position_m", lambda a: put(a, 0, 1e300)), "within 1e9 m"),
    "overflowing scale": (array_with("nodes/scale", lambda a: put(a, 0, 1.7e308)), "within 1e9 m"),
    "zero scale": (array_with("nodes/scale", lambda a: put(a, 0, 0.0)), "scale"),
    "long quaternion": (array_with("nodes/orientation_xyzw", lambda a: a * 1e200), "unit"),
    "own parent": (array_with("nodes/parent", lambda a: put(a, 4, 4)), "parent"),
    "odd boolean": (
        lambda m: m | {"nodes/additive.npy": m["nodes/additive.npy"][:-1] + b"\x07"},
        "bytes 0 and 1",
    ),
    "motion of no node": (array_with("motion/node", lambda a: put(a, 0, 99)), "motion node"),
    "levels of nobody": (array_with("levels/start", lambda a: put(a, 0, 1)), "level start"),
    "levels out of order": (array_with("levels/start", lambda a: put(a, 1, 9)), "level"),
    "no levels": (array_with("levels/start", lambda a: a[:0]), "continuous"),
    "falling error": (array_with("levels/error_m", lambda a: put(a, 1, 9.0)), "finest first"),
    "negative bytes": (array_with("levels/bytes", lambda a: -a), "level bytes"),
    "infinite radius": (array_with("types/radius_m", lambda a: a * np.inf), "radius_m"),
}

GEOMETRY_DAMAGE: dict[str, tuple[Callable[[Members], Members], str]] = {
    "index out of range": (array_with("geometry/faces", lambda a: put(a, 0, 10**6)), "faces"),
    "negative index": (array_with("geometry/faces", lambda a: put(a, 0, -1)), "faces"),
    "NaN vertex": (array_with("geometry/vertices", lambda a: put(a, 0, np.nan)), "finite"),
    "NaN uv": (array_with("geometry/uv", lambda a: put(a, 0, np.nan)), "finite"),
    "uv too short": (array_with("geometry/uv", lambda a: a[:-1]), "uv"),
    "normals too short": (array_with("geometry/normals", lambda a: a[:-1]), "rising"),
    "starts too few": (array_with("geometry/face_start", lambda a: a[:-1]), "rising"),
    "starts that fall": (array_with("geometry/face_start", lambda a: put(a, 1, 10**9)), "rising"),
    "parts beyond": (array_with("geometry/part_start", lambda a: put(a, 1, 9)), "part_start"),
    "flags too few": (array_with("geometry/has_uv", lambda a: a[:-1]), "has_uv"),
    "two columns": (array_with("geometry/faces", lambda a: a[:, :2].copy()), "mesh faces"),
}


@pytest.mark.parametrize("case", SCENE_DAMAGE)
def test_damaged_scenes_are_refused(case: str, members: Members, tmp_path: Path) -> None:
    """Each kind of damage is an input error that names the file and the part."""
    change, message = SCENE_DAMAGE[case]
    path = pack(tmp_path / "bad.lodscene", change(members))
    with pytest.raises(InputError) as info:
        read_scene(path)
    assert message in info.value.message
    assert info.value.path == str(path)


@pytest.mark.parametrize("case", GEOMETRY_DAMAGE)
def test_damaged_geometry_is_refused(case: str, members: Members, tmp_path: Path) -> None:
    """Damage of the geometry is found when it is read, and does not stop the scene."""
    change, message = GEOMETRY_DAMAGE[case]
    path = pack(tmp_path / "bad.lodscene", change(members))
    assert len(read_scene(path)) == 20
    with pytest.raises(InputError) as info:
        read_geometry(path)
    assert message in info.value.message
    assert info.value.path == str(path)


def test_a_bomb_is_refused_before_it_is_unpacked(members: Members, tmp_path: Path) -> None:
    """A gigabyte of zeros in a small file costs neither time nor memory."""
    path = tmp_path / "bomb.lodscene"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
        with archive.open("nodes/more.npy", "w", force_zip64=True) as member:
            for _ in range(256):
                member.write(bytes(1 << 20))
    begin = time.perf_counter()
    with pytest.raises(InputError, match="expected stored members, got compressed"):
        read_scene(path)
    assert time.perf_counter() - begin < 0.5


@pytest.mark.parametrize("shape", ["(1000000000000,)", "(-20,)", "(21,)", "(True,)", "20"])
def test_absurd_shapes_are_refused(shape: str, members: Members, tmp_path: Path) -> None:
    """A header that declares what the member does not hold is refused without allocation."""
    good = members["nodes/scale.npy"]
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"
    bad = good[:10] + text.ljust(117).encode() + b"\n" + good[128:]
    path = pack(tmp_path / "bad.lodscene", members | {"nodes/scale.npy": bad})
    with pytest.raises(InputError, match=r"nodes/scale\.npy"):
        read_scene(path)


def test_declared_sizes_beyond_the_file_are_refused(members: Members, tmp_path: Path) -> None:
    """Central directories that promise gigabytes are not believed."""
    path = pack(tmp_path / "bad.lodscene", members)
    data = bytearray(path.read_bytes())
    entry = data.index(b"PK\x01\x02")
    data[entry + 20 : entry + 28] = b"\xff\xff\xff\x7f" * 2
    path.write_bytes(data)
    with pytest.raises(InputError, match="larger declared sizes"):
        read_scene(path)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"\xff\xfe" * 300, b"text\n" * 99])
def test_other_files_are_refused(content: bytes, tmp_path: Path) -> None:
    """What is no archive is refused as such."""
    path = tmp_path / "odd.lodscene"
    path.write_bytes(content)
    with pytest.raises(InputError, match="expected a zip archive"):
        read_scene(path)


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_any_damage_is_an_input_error_or_harmless(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory, good_bytes: bytes
) -> None:
    """Truncated anywhere, or with some bytes changed, a file is refused or read, never a crash."""
    path = tmp_path_factory.mktemp("damage") / "bad.lodscene"
    content = bytearray(good_bytes)
    if data.draw(st.booleans()):
        del content[data.draw(st.integers(0, len(content) - 1)) :]
    else:
        for _ in range(data.draw(st.integers(1, 4))):
            content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content)
    for read in (read_scene, read_geometry, read_origin):
        with suppress(InputError):
            read(path)


@pytest.fixture(scope="module")
def good_bytes(
    ball_scene: tuple[Scene, Geometry], tmp_path_factory: pytest.TempPathFactory
) -> bytes:
    """Return the bytes of a small file, mostly of headers: two nodes, one triangle a level."""
    corners = np.eye(3, dtype=np.float32)
    triangle = LevelMesh(corners, corners, np.array([[0, 1, 2]]), np.array([0, 1]))
    path = tmp_path_factory.mktemp("good") / "good.lodscene"
    write_scene(path, ball_scene[0], (triangle,) * 5)
    return path.read_bytes()


def test_scenes_may_have_no_geometry(ball_scene: tuple[Scene, Geometry], tmp_path: Path) -> None:
    """A scene without meshes, as of a tileset, is written and read; its geometry is empty."""
    write_scene(tmp_path / "bare.lodscene", ball_scene[0], ())
    assert len(read_scene(tmp_path / "bare.lodscene")) == 20
    assert read_geometry(tmp_path / "bare.lodscene") == ()
