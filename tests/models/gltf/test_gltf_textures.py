"""Textures of glTF files: what KTX2 headers say, and that no texture is lost silently."""

import io
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import trimesh
from PIL import Image

from lodbench import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.gltf.gltf_lod import read_gltf_scene
from lodbench.models.gltf.ktx2 import is_ktx2, ktx2_bytes
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.mesh_file import load_mesh

FEW = Sampling(vertices=200, surface=200)
BC7_UNORM, RGBA8_UNORM = 145, 37
ETC1S, UASTC = 163, 166
BYTES, TEXTURED = (LEVEL_PREDICTORS.index(n) for n in ("texture_bytes", "textured_triangles"))


def ktx2(
    size: tuple[int, int],
    sizes: Sequence[int],
    *,
    file_format: int = 0,
    model: int = UASTC,
    samples: int = 1,
    scheme: int = 0,
    layers: int = 0,
    faces: int = 1,
    levels: int | None = None,
) -> bytes:
    """Return a header, an index of levels of so many uncompressed bytes, and a descriptor."""
    at = 80 + 24 * max(len(sizes), 1)
    block = struct.pack("<IHH", 0, 2, 24 + 16 * samples) + bytes([model]) + bytes(15 + 16 * samples)
    descriptor = struct.pack("<I", 4 + len(block)) + block
    count = len(sizes) if levels is None else levels
    words = (file_format, 1, *size, 0, layers, faces, count, scheme, at, len(descriptor), 0, 0)
    head = b"\xabKTX 20\xbb\r\n\x1a\n" + struct.pack("<13I", *words) + bytes(16)
    index = b"".join(struct.pack("<3Q", 0, 1, n) for n in sizes)
    return head + index + descriptor


def test_formats_of_the_gpu_take_what_they_hold() -> None:
    """BC7 of 64 by 64: 4,096 bytes, then a quarter each, at least a block of 16."""
    sizes = [4096, 1024, 256, 64, 16, 16, 16]
    assert ktx2_bytes(ktx2((64, 64), sizes, file_format=BC7_UNORM)) == sum(sizes)
    # Whatever the file is packed by.
    assert ktx2_bytes(ktx2((64, 64), sizes, file_format=BC7_UNORM, scheme=2)) == sum(sizes)


def test_basis_becomes_blocks() -> None:
    """64 by 32: 16 · 8 blocks, then 8 · 4; 16 bytes each of UASTC, 8 of ETC1S, 16 with alpha."""
    blocks = 128 + 32
    assert ktx2_bytes(ktx2((64, 32), [0, 0])) == 16 * blocks
    etc = {"model": ETC1S, "scheme": 1}
    assert ktx2_bytes(ktx2((64, 32), [0, 0], **etc)) == 8 * blocks
    assert ktx2_bytes(ktx2((64, 32), [0, 0], samples=2, **etc)) == 16 * blocks
    # Of sides that are no multiple of four, blocks are whole: 5 by 3 takes two.
    assert ktx2_bytes(ktx2((5, 3), [0])) == 32


def test_layers_faces_and_levels_left_to_the_loader() -> None:
    """A cube of three layers is 18 images; without levels, the mip chain is a third more."""
    assert ktx2_bytes(ktx2((64, 64), [0], layers=3, faces=6)) == 18 * 16 * 256
    assert ktx2_bytes(ktx2((64, 64), [0], levels=0)) == pytest.approx(16 * 256 * 4 / 3)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\x89PNG\r\n\x1a\n" + bytes(100),
        ktx2((64, 64), [0])[:79],
        ktx2((64, 64), [0])[:100],
        ktx2((0, 64), [0]),
        ktx2((1 << 20, 64), [0]),
        ktx2((64, 64), [0] * 8),
        ktx2((64, 64), [0], faces=5),
        ktx2((64, 64), [0], layers=1 << 30),
        ktx2((64, 64), [0], model=7),
        ktx2((64, 64), [1 << 60], file_format=RGBA8_UNORM),
    ],
)
def test_damaged_headers_are_refused(data: bytes) -> None:
    """In one line, whatever is wrong: no size comes of them."""
    with pytest.raises(InputError, match="expected"):
        ktx2_bytes(data)


def test_any_header_gives_a_size_or_is_refused() -> None:
    """2,000 headers with bytes changed at random: no other exception, no endless size."""
    rng = np.random.default_rng(0)
    whole = np.frombuffer(ktx2((64, 64), [0, 0, 0]), np.uint8)
    for _ in range(2_000):
        data = whole.copy()
        at = rng.integers(12, len(data), 3)
        data[at] = rng.integers(0, 256, 3)
        try:
            size = ktx2_bytes(data.tobytes())
        except InputError:
            continue
        assert 0.0 <= size < 1e15


def write_gltf(folder: Path, images: list[dict[str, Any]], textures: list[dict[str, Any]]) -> Path:
    """Write a quad whose material shows texture 0 as colour and texture 1, if any, as normals."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], dtype=np.float32)
    faces = np.array((0, 1, 2, 0, 2, 3), dtype=np.uint32)
    uv = corners[:, :2].copy()
    data = corners.tobytes() + uv.tobytes() + faces.tobytes()
    (folder / "quad.bin").write_bytes(data)
    view = [(0, 48), (48, 32), (80, 24)]
    kinds = ((5126, 4, "VEC3"), (5126, 4, "VEC2"), (5125, 6, "SCALAR"))
    material: dict[str, Any] = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    if len(textures) > 1:
        material["normalTexture"] = {"index": 1}
    attributes = {"POSITION": 0, "TEXCOORD_0": 1}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "quad"}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 2, "material": 0}]}],
        "accessors": [
            {"bufferView": i, "componentType": c, "count": n, "type": kind}
            for i, (c, n, kind) in enumerate(kinds)
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": n} for at, n in view],
        "buffers": [{"byteLength": len(data), "uri": "quad.bin"}],
        "materials": [material],
        "textures": textures,
        "images": images,
    }
    path = folder / "quad.gltf"
    path.write_bytes(msgspec.json.encode(document))
    return path


BASISU = [{"extensions": {"KHR_texture_basisu": {"source": 0}}}]


def test_ktx2_of_a_file_counts_in_both_readers(tmp_path: Path) -> None:
    """As a scene and as a mesh of `scene build`; trimesh alone would leave the texture out."""
    (tmp_path / "skin.ktx2").write_bytes(ktx2((64, 32), [0, 0]))
    images = [{"uri": "skin.ktx2", "mimeType": "image/ktx2"}]
    path = write_gltf(tmp_path, images, BASISU)
    scene, _, _ = read_gltf_scene(path, FEW)
    assert scene.types.levels.counts[0, BYTES] == 16 * 160
    assert scene.types.levels.counts[0, TEXTURED] == 2.0
    surface = load_mesh(path)
    assert surface.texture_bytes == 16 * 160
    assert surface.textured.tolist() == [True]
    assert surface.has_uv
    assert np.ptp(surface.positions, axis=0).tolist() == [1.0, 1.0, 0.0]


def test_the_image_of_the_extension_stands_in_for_the_other(tmp_path: Path) -> None:
    """A renderer that knows KTX2 shows it, and not the PNG for those that do not."""
    (tmp_path / "skin.ktx2").write_bytes(ktx2((64, 32), [0]))
    Image.new("RGB", (256, 256)).save(tmp_path / "skin.png")
    images = [{"uri": "skin.ktx2"}, {"uri": "skin.png"}]
    path = write_gltf(tmp_path, images, [BASISU[0] | {"source": 1}])
    assert read_gltf_scene(path, FEW)[0].types.levels.counts[0, BYTES] == 16 * 128


def test_plain_images_count_as_rgba8_with_mips_and_once(tmp_path: Path) -> None:
    """A PNG of 64 by 32 that two textures show: 64 · 32 · 4 · 4 / 3 bytes, in both readers."""
    packed = io.BytesIO()
    Image.new("RGB", (64, 32)).save(packed, "PNG")
    (tmp_path / "skin.png").write_bytes(packed.getvalue())
    path = write_gltf(tmp_path, [{"uri": "skin.png"}], [{"source": 0}, {"source": 0}])
    size = read_gltf_scene(path, FEW)[0].types.levels.counts[0, BYTES]
    assert size == pytest.approx(64 * 32 * 16 / 3)
    assert load_mesh(path).texture_bytes == pytest.approx(size)


def test_what_cannot_be_counted_is_named(tmp_path: Path) -> None:
    """A scene says which textures are not there; a mesh to build from is refused by their names."""
    path = write_gltf(tmp_path, [{"uri": "lost.ktx2"}], BASISU)
    scene, _, origin = read_gltf_scene(path, FEW)
    assert scene.types.levels.counts[0, BYTES] == 0.0
    assert scene.types.levels.counts[0, TEXTURED] == 2.0
    assert origin.options["textures_not_counted"] == "lost.ktx2"
    with pytest.raises(InputError, match=r"quad.gltf: expected its textures .* lost.ktx2"):
        load_mesh(path)
    (tmp_path / "lost.ktx2").write_bytes(b"no texture")
    _, _, origin = read_gltf_scene(path, FEW)
    assert origin.options["textures_not_counted"] == "lost.ktx2"


def test_a_glb_without_ktx2_is_read_as_before(tmp_path: Path) -> None:
    """By trimesh, whose reading of parts and materials others rely on."""
    trimesh.creation.icosphere(subdivisions=1).export(tmp_path / "ball.glb")
    assert len(load_mesh(tmp_path / "ball.glb").faces) == 80
    assert not is_ktx2(b"glTF")
