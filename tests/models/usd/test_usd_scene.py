"""USD files as scenes: variants as levels, hands, mirrors, instances, materials."""

from pathlib import Path

import numpy as np
import pytest

from lodbench import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.cli.main import run
from lodbench.models.meshes.geometry import LevelMesh
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.scene.scene_catalog import open_scene
from lodbench.models.usd import usd_scene
from lodbench.models.usd.usd_scene import read_usd_scene

pytest.importorskip("pxr", reason="usd-core is only in the extras `usd` and `dev`")

FEW = Sampling(vertices=200, surface=200)
DRAWS, TRIANGLES = (LEVEL_PREDICTORS.index(name) for name in ("draw_calls", "triangles"))
CORNERS = "(0,0,0), (1,0,0), (1,1,0), (0,1,0), (0,0,1), (1,0,1), (1,1,1), (0,1,1)"
OUTWARD = "0,3,2,1, 4,5,6,7, 0,1,5,4, 1,2,6,5, 2,3,7,6, 3,0,4,7"
INWARD = "1,2,3,0, 7,6,5,4, 4,5,1,0, 5,6,2,1, 6,7,3,2, 7,4,0,3"


def cube(name: str, corners: str = OUTWARD, more: str = "", kind: str = "Mesh") -> str:
    """Return a unit cube of six quads."""
    return f"""
def {kind} "{name}"
{{
    int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]
    int[] faceVertexIndices = [{corners}]
    point3f[] points = [{CORNERS}]
    {more}
}}"""


def square(name: str) -> str:
    """Return a single quad: the foot of the cube."""
    return f"""
def Mesh "{name}"
{{
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 3, 2, 1]
    point3f[] points = [(0,0,0), (1,0,0), (1,1,0), (0,1,0)]
}}"""


def moved(x: float, y: float, z: float, scale: str = "(1, 1, 1)") -> str:
    """Return properties that place a prim."""
    return f"""double3 xformOp:translate = ({x}, {y}, {z})
    float3 xformOp:scale = {scale}
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]"""


def write(folder: Path, body: str, *, up: str = "Z", unit_m: float = 1.0) -> Path:
    """Write a text layer."""
    path = folder / "scene.usda"
    head = f'#usda 1.0\n(\n    metersPerUnit = {unit_m}\n    upAxis = "{up}"\n)\n'
    path.write_text(head + body, encoding="utf-8")
    return path


def with_variants(set_name: str, variants: dict[str, str], place: str = "") -> str:
    """Return a prim of which each variant has other prims below."""
    inner = "\n".join(f'"{name}" {{\n{prims}\n}}' for name, prims in variants.items())
    first = next(iter(variants))
    return f"""
def Xform "rock" (
    variants = {{ string {set_name} = "{first}" }}
    prepend variantSets = "{set_name}"
)
{{
    {place}
    variantSet "{set_name}" = {{
        {inner}
    }}
}}"""


def volume(mesh: LevelMesh) -> float:
    """Return the signed volume of a closed mesh, positive where its faces look outward."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]].astype(np.float64) for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


@pytest.mark.parametrize(
    ("set_name", "names"),
    [("LOD", ("lod10", "lod2")), ("lodVariant", ("high", "low")), ("modelLOD", ("b1", "a2"))],
)
def test_variants_are_levels(tmp_path: Path, set_name: str, names: tuple[str, str]) -> None:
    """By the numbers in their names, or as they come; y up in centimetres becomes z and metres."""
    fine, coarse = (cube("m"), square("m"))
    variants = dict(zip(names, (fine, coarse), strict=True))
    if names[0] == "lod10":
        variants = {"lod10": coarse, "lod2": fine}
    body = with_variants(set_name, variants, moved(300, 0, 200, "(100, 100, 100)"))
    scene, geometry, origin = read_usd_scene(write(tmp_path, body, up="Y", unit_m=0.01), FEW)
    assert scene.types.names == ("rock",)
    assert scene.types.levels.counts[:, TRIANGLES].tolist() == [12.0, 2.0]
    # What is farthest from the foot is the far side, a metre away.
    assert scene.types.levels.error_m.tolist() == pytest.approx([0.0, 1.0])
    # x, y and z of the file are x, z and -y of the scene.
    assert scene.position_m.tolist() == [[3.0, -2.0, 0.0]]
    assert volume(geometry[0]) == pytest.approx(1.0)
    assert origin.options == {"objects_with_levels": 1, "point_instancers_not_read": 0}
    assert (tmp_path / "scene.usda").read_text(encoding="utf-8").count("variantSet ") == 1


def test_what_moves_stands_where_it_begins(tmp_path: Path) -> None:
    """Exporters write positions, and points that bend, by time alone: none is lost or misplaced."""
    walks = """double3 xformOp:translate.timeSamples = { 24: (9, 0, 0), 1: (5, 0, 0) }
    uniform token[] xformOpOrder = ["xformOp:translate"]"""
    waves = cube("waves", more=moved(0, 7, 0)).replace(
        f"points = [{CORNERS}]", f"points.timeSamples = {{ 1: [{CORNERS}] }}"
    )
    scene, geometry, _ = read_usd_scene(write(tmp_path, cube("walks", more=walks) + waves), FEW)
    assert scene.position_m.tolist() == [[5.0, 0.0, 0.0], [0.0, 7.0, 0.0]]
    assert [volume(mesh) for mesh in geometry] == pytest.approx([1.0])


def test_hands_and_mirrors_turn_the_winding(tmp_path: Path) -> None:
    """A cube looks outward whatever hand it was made by and however it is mirrored."""
    left = 'uniform token orientation = "leftHanded"'
    body = (
        cube("right")
        + cube("left", INWARD, left)
        + cube("mirrored", OUTWARD, moved(5, 0, 0, "(-1, 1, 1)"))
        + cube("both", INWARD, left + "\n    " + moved(9, 0, 0, "(1, 1, -2)"))
    )
    _, geometry, _ = read_usd_scene(write(tmp_path, body), FEW)
    volumes = sorted(volume(mesh) for mesh in geometry)
    assert min(volumes) == pytest.approx(1.0)
    assert max(volumes) == pytest.approx(2.0)


def test_equal_meshes_share_a_type_and_instances_are_followed(tmp_path: Path) -> None:
    """Two references to one cube and an instance of it, which stand in three places."""
    proto = f'class "proto"\n{{\n{cube("m")}\n}}'
    uses = [
        f'def Xform "a{i}" (instanceable = {flag}\n prepend references = </proto>\n)'
        f"\n{{\n{moved(i, 0, 0)}\n}}"
        for i, flag in enumerate(("true", "true", "false"))
    ]
    scene, geometry, _ = read_usd_scene(write(tmp_path, "\n".join((proto, *uses))), FEW)
    assert len(scene) == 3
    assert len(geometry) == 1
    assert sorted(scene.position_m[:, 0].tolist()) == [0.0, 1.0, 2.0]


def test_subsets_of_materials_are_draws_and_holes_are_none(tmp_path: Path) -> None:
    """Two of six faces have a material of their own, one is a hole: two draws, ten triangles."""
    subset = """
    uniform token subsetFamily:materialBind:familyType = "nonOverlapping"
    int[] holeIndices = [5]
    def GeomSubset "top" (prepend apiSchemas = ["MaterialBindingAPI"])
    {
        uniform token elementType = "face"
        uniform token familyName = "materialBind"
        int[] indices = [0, 1]
        rel material:binding = </paint>
    }"""
    body = 'def Material "paint" {}' + cube("m", OUTWARD, subset)
    scene, geometry, _ = read_usd_scene(write(tmp_path, body), FEW)
    assert scene.types.levels.counts[0, [DRAWS, TRIANGLES]].tolist() == [2.0, 10.0]
    assert sorted(np.diff(geometry[0].part_start).tolist()) == [4, 6]


def test_what_is_not_drawn_is_left_out_and_what_is_not_read_is_counted(tmp_path: Path) -> None:
    """Invisible prims and guides are no objects; point instancers are named."""
    body = (
        cube("seen")
        + cube("hidden", OUTWARD, 'token visibility = "invisible"')
        + cube("guide", OUTWARD, 'uniform token purpose = "guide"')
        + '\ndef PointInstancer "grass" {}'
    )
    scene, _, origin = read_usd_scene(write(tmp_path, body), FEW)
    assert scene.types.names == ("seen",)
    assert origin.options["point_instancers_not_read"] == 1


def test_what_is_referenced_and_not_there_is_told(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """By the origin, which `scene info` shows, and not by the library on stderr."""
    body = cube("m") + '\ndef Xform "a" (prepend references = @./gone.usda@)\n{\n}'
    scene, _, origin = read_usd_scene(write(tmp_path, body), FEW)
    assert len(scene) == 1
    lost = str(origin.options["references_not_read"])
    assert lost.startswith("1, first: ")
    assert "gone.usda" in lost
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ('def Xform "empty" {}', "expected a mesh with triangles, got none"),
        (cube("m", OUTWARD.replace("7", "9")), "/m: expected indices of 8 points"),
        (cube("m", OUTWARD[:-2]), "/m: expected 24 corners of faces, got 23"),
        (cube("m", OUTWARD, moved(0, 0, 0, "(0, 1, 1)")), "/m: expected a transform"),
        (with_variants("LOD", {"lod0": square("m"), "lod1": cube("m")}), "finest first"),
        ("def Mesh {{{", "got a damaged one ("),
    ],
)
def test_refusals(tmp_path: Path, body: str, message: str) -> None:
    """One line, with the file and what is wrong."""
    path = write(tmp_path, body)
    with pytest.raises(InputError) as refused:
        read_usd_scene(path, FEW)
    assert message in str(refused.value)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_without_the_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What to install is said; a file that is not there is told before."""
    monkeypatch.setattr(usd_scene, "find_spec", {"pxr": None}.get)
    with pytest.raises(InputError, match=r"expected usd-core, got none; .*lodbench\[usd\]"):
        read_usd_scene(write(tmp_path, cube("m")), FEW)
    with pytest.raises(InputError, match="got no such file"):
        read_usd_scene(tmp_path / "none.usda", FEW)


def test_by_its_path(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Wherever a scene is named, a USD file may stand; `scene info` tells what was not read."""
    body = cube("m") + '\ndef Xform "a" (prepend references = @./[/b]gone.usda@)\n{\n}'
    path = str(write(tmp_path, body))
    opened = open_scene(path)
    assert len(opened.scene) == 1
    assert len(opened.read_geometry()) == 1
    assert run(["scene", "info", path]) == 0
    printed = capsys.readouterr().out
    assert "objects with levels: 0, point instancers not read: 0, references not read: 1" in printed
    assert "[/b]gone.usda" in printed
