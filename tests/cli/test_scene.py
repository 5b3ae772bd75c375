"""`lodbench scene`: from meshes to a file and its tables."""

import json
from pathlib import Path
from typing import Any

import pytest
import trimesh

from lodbench.cli.main import run
from lodbench.models.scene.scene_file import read_geometry, read_origin, read_scene


@pytest.fixture
def meshes(tmp_path: Path) -> list[str]:
    """Files of a ball of 1,280 triangles and of a box."""
    trimesh.creation.icosphere(subdivisions=3).export(tmp_path / "ball.ply")
    trimesh.creation.box().export(tmp_path / "box.obj")
    return [str(tmp_path / "ball.ply"), str(tmp_path / "box.obj")]


def document(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """Return the one JSON document on stdout; nothing else is printed."""
    printed = capsys.readouterr()
    assert printed.err == ""
    return json.loads(printed.out)


def test_build_then_info(
    meshes: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What build reports is what info reads from the file."""
    out = str(tmp_path / "two.lodscene")
    options = ["--layout", "grid", "--count", "30", "--levels", "4", "--seed", "5", "--json"]
    assert run(["scene", "build", *meshes, "--out", out, *options]) == 0
    built = document(capsys)
    assert run(["scene", "info", out, "--json"]) == 0
    shown = document(capsys)
    assert built.pop("schema") == "lodbench.scene-build/1"
    assert shown.pop("schema") == "lodbench.scene-info/1"
    assert built == shown
    assert shown["objects"] == 30
    ball, box = shown["types"]
    assert [level["triangles"] for level in ball["levels"]] == [1280, 640, 320, 160]
    assert [level["triangles"] for level in box["levels"]] == [12]
    assert (ball["objects"], box["objects"]) == (15, 15)
    assert shown["triangles"] == 15 * 1280 + 15 * 12
    assert shown["origin"]["sources"] == ["ball.ply", "box.obj"]
    assert shown["origin"]["options"]["seed"] == 5
    assert len(read_scene(Path(out))) == 30
    assert len(read_geometry(Path(out))) == 5
    assert read_origin(Path(out)).tool.startswith("lodbench ")


def test_same_seed_same_bytes(meshes: list[str], tmp_path: Path) -> None:
    """Two builds of one seed are equal files, another seed differs."""
    files: list[bytes] = []
    for name, seed in (("a", "1"), ("b", "1"), ("c", "2")):
        folder = tmp_path / name
        folder.mkdir()
        out = folder / "scene.lodscene"
        options = ["--seed", seed, "--levels", "2", "--count", "20"]
        assert run(["scene", "build", *meshes, "--out", str(out), *options]) == 0
        files.append(out.read_bytes())
    assert files[0] == files[1] != files[2]


def test_table_shows_every_level(
    meshes: list[str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Counts, errors and the extent stand in the table at 80 columns."""
    monkeypatch.setenv("COLUMNS", "80")
    out = str(tmp_path / "two.lodscene")
    assert run(["scene", "build", *meshes, "--out", out, "--levels", "3"]) == 0
    capsys.readouterr()
    assert run(["scene", "info", out]) == 0
    table = capsys.readouterr().out
    assert "…" not in table
    for text in ("ball", "box", "1,280", "640", "320", "500 objects, 0 moving", "extent"):
        assert text in table


def test_info_of_the_bundled_scene(capsys: pytest.CaptureFixture[str]) -> None:
    """The bundled scene is shown by its name."""
    assert run(["scene", "info", "plaza", "--json"]) == 0
    shown = document(capsys)
    assert shown["objects"] == 3_000
    assert shown["moving"] == 500
    assert shown["origin"]["tool"] == "bundled"


def test_a_refused_mesh_leaves_no_file(
    meshes: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One bad mesh among good ones: exit 2, its name and the reason, nothing written."""
    bad = tmp_path / "cloud.obj"
    bad.write_text("v 0 0 0\n")
    before = sorted(tmp_path.iterdir())
    out = tmp_path / "two.lodscene"
    assert run(["scene", "build", *meshes, str(bad), "--out", str(out)]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith(f"error: {bad}: expected")
    assert printed.err.count("\n") == 1
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--layout", "spiral"], "expected one of grid, scatter, rows, city, forest or"),
        (["--count", "0"], "count: expected 1"),
        (["--seed", "-1"], "seed: expected"),
        (["--levels", "0"], "levels: expected 1"),
        (["--ratio", "2"], "ratio: expected"),
        (["--up", "w"], "up axis: expected y or z, got w"),
        (["--height-m", "nan"], "height: expected"),
        (["--spacing-m", "-3"], "spacing: expected"),
        (["--side-m", "5"], "layout scatter: expected a side of at least"),
        (["--scale-variation", "1"], "scale variation: expected"),
    ],
)
def test_bad_options_are_refused(
    options: list[str],
    message: str,
    meshes: list[str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Each option out of range is one line, exit 2, and no file."""
    out = tmp_path / "two.lodscene"
    assert run(["scene", "build", *meshes, "--out", str(out), *options]) == 2
    assert message in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(
    ("name", "message"),
    [("two.zip", "expected a name that ends in .lodscene"), ("no/two.lodscene", "a folder")],
)
def test_a_useless_target_is_refused_before_the_work(
    name: str,
    message: str,
    meshes: list[str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A name by which the file would not be found, or a folder that is not there."""
    assert run(["scene", "build", *meshes, "--out", str(tmp_path / name)]) == 2
    assert message in capsys.readouterr().err


def test_a_damaged_scene_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A file that is no scene is refused by its path."""
    path = tmp_path / "odd.lodscene"
    path.write_bytes(b"\x00\xff" * 99)
    assert run(["scene", "info", str(path)]) == 2
    assert capsys.readouterr().err.startswith(f"error: {path}: expected a zip archive")


def test_info_of_a_tileset(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A tileset is shown by depth, with what was read of it and what was not."""
    ball = {"sphere": [0, 0, 0, 10]}
    leaf = {"boundingVolume": ball, "content": {"uri": "gone.b3dm"}}
    root = {"boundingVolume": ball, "geometricError": 5, "refine": "ADD", "children": [leaf, leaf]}
    path = tmp_path / "tileset.json"
    path.write_text(json.dumps({"asset": {"version": "1.1"}, "root": root}), encoding="utf-8")
    assert run(["scene", "info", str(path), "--json"]) == 0
    shown = document(capsys)
    assert [depth["nodes"] for depth in shown["depths"]] == [1, 2]
    assert [depth["error_m_max"] for depth in shown["depths"]] == [5.0, 0.0]
    assert run(["scene", "info", str(path)]) == 0
    table = capsys.readouterr().out
    assert "nodes by depth" in table
    assert "contents missing: 2" in table
    assert "errors missing read as 0: 2" in table


def test_full_detail_is_what_the_leaves_draw(capsys: pytest.CaptureFixture[str]) -> None:
    """In a flat scene that is every object at its finest level."""
    assert run(["scene", "info", "plaza", "--json"]) == 0
    shown = document(capsys)
    finest = sum(kind["objects"] * kind["levels"][0]["triangles"] for kind in shown["types"])
    assert shown["triangles"] == finest
    assert shown["depths"] == []


def test_build_a_tree(
    meshes: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A ball of 1,280 triangles in nodes of 200: factors 6.4 and 1.6, then the full mesh."""
    out = str(tmp_path / "tree.lodscene")
    options = ["--desired-triangles", "200", "--count", "3", "--json"]
    assert run(["scene", "build-hlod", meshes[0], "--out", out, *options]) == 0
    built = document(capsys)
    nodes = [depth["nodes"] for depth in built["depths"]]
    assert nodes[:2] == [3, 12]
    assert len(nodes) == 3
    assert built["triangles"] >= 3 * 1280
    assert built["objects"] == sum(nodes) == len(read_scene(Path(out)))
    assert len(read_geometry(Path(out))) == len(built["types"])
    assert run(["scene", "build-hlod", meshes[0], "--out", out, "--level-factor", "1"]) == 2
    assert "level factor: expected 2 to 16" in capsys.readouterr().err


def test_info_draws_a_picture(
    meshes: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A PNG of the frame beside the numbers; a wrong name, frame or policy is refused in a line."""
    scene, picture = str(tmp_path / "two.lodscene"), tmp_path / "two.png"
    options = ["--count", "20", "--levels", "2"]
    assert run(["scene", "build", *meshes, "--out", scene, *options]) == 0
    capsys.readouterr()
    options = ["--picture", str(picture), "--frame", "3", "--policy", "full"]
    assert run(["scene", "info", scene, *options, "--json"]) == 0
    assert document(capsys)["objects"] == 20
    assert picture.read_bytes()[:4] == b"\x89PNG"
    for wrong, message in (
        (["--picture", str(tmp_path / "two.jpg")], "ends in .png"),
        (["--picture", str(tmp_path / "no" / "two.png")], "a folder to write to"),
        (["--picture", str(picture), "--frame", "-1"], "frame: expected"),
        (["--picture", str(picture), "--policy", "maciel"], "maciel: expected a policy that fits"),
    ):
        assert run(["scene", "info", scene, *wrong]) == 2
        printed = capsys.readouterr()
        assert message in printed.err
        assert printed.out == ""
