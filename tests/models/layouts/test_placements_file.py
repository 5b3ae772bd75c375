"""Objects stand where a file places them."""

import json
from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.layouts.placements_file import read_placements
from lodbench.models.scene.rotation import rotate

TYPES = ("rock", "tree")


def written(tmp_path: Path, name: str, text: str) -> Path:
    """Return the path of a file with this text."""
    path = tmp_path / name
    path.write_text(text)
    return path


def test_csv_places_turns_and_scales(tmp_path: Path) -> None:
    """Defaults stand for what a row leaves out; a yaw of 90 degrees takes x to y."""
    text = "type,x,y,z,yaw_deg,scale,importance\ntree,1,2,3,90,2,\nrock,-4,5,0,,,7\n"
    found = read_placements(written(tmp_path, "a.csv", text), TYPES, y_up=False)
    assert found.type_index.tolist() == [1, 0]
    assert found.position_m.tolist() == [[1.0, 2.0, 3.0], [-4.0, 5.0, 0.0]]
    ahead = np.tile((1.0, 0.0, 0.0), (2, 1))
    assert rotate(found.turn_xyzw, ahead) == pytest.approx(np.array([[0, 1, 0], [1, 0, 0]]))
    assert (found.scale.tolist(), found.importance.tolist()) == ([2.0, 1.0], [1.0, 7.0])


def test_json_with_y_up_is_turned_as_meshes_are(tmp_path: Path) -> None:
    """(1, 2, 3) with y up and 100 units a metre is (0.01, -0.03, 0.02); a turn about y, about z."""
    half = float(np.sqrt(0.5))
    records = [
        {"mesh": "rock.obj", "position": [1, 2, 3], "rotation": [0, half, 0, half]},
        {"type": "rock", "x": 0, "y": 0, "z": 0, "yaw_deg": 90},
    ]
    path = written(tmp_path, "a.json", json.dumps({"instances": records}))
    found = read_placements(path, TYPES, y_up=True, unit_m=0.01)
    assert found.position_m[0] == pytest.approx((0.01, -0.03, 0.02))
    ahead = np.tile((1.0, 0.0, 0.0), (2, 1))
    assert rotate(found.turn_xyzw, ahead) == pytest.approx(np.array([[0, 1, 0], [0, 1, 0]]))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("type,x,y,z\nrok,1,2,3\n", r"a\.csv:2: type: .*did you mean rock"),
        ("type,x,y,z\nrock,1,,3\n", r"a\.csv:2: expected y of a place"),
        ("type,x,y,z\nrock,1,nan,3\n", r"a\.csv:2: expected a number within 1e9 for y"),
        ("type,x,y,z\nrock,1,2,3,4\n", r"a\.csv:2: expected 4 cells as in the header, got more"),
        ("type,x,y,z,scale\nrock,1,2,3,-1\n", "expected a scale above 0"),
        ("type,x,y,z,qx,qy,qz,qw\nrock,1,2,3,5,0,0,1\n", "expected a unit quaternion"),
        ("type,x,y,z\n", "expected an object, got none"),
        ("x,y,z\n1,2,3\n", "expected the name of a mesh"),
    ],
)
def test_bad_rows_are_refused_by_line(tmp_path: Path, text: str, message: str) -> None:
    """Each says where and what."""
    with pytest.raises(InputError, match=message):
        read_placements(written(tmp_path, "a.csv", text), TYPES, y_up=False)


@pytest.mark.parametrize("text", ["{", "{}", "[1]", '[{"type": "rock", "position": 3}]', "[]"])
def test_other_json_is_refused(tmp_path: Path, text: str) -> None:
    """Whatever else it holds, one line tells."""
    with pytest.raises(InputError):
        read_placements(written(tmp_path, "a.json", text), TYPES, y_up=False)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.csv", "type,x,y,z,rotation_y,Layer\nrock,1,2,3,90,grass\n"),
        ("a.json", '[{"type": "rock", "position": [1, 2, 3], "rotation_y": 90, "Layer": 1}]'),
    ],
)
def test_columns_that_say_nothing_are_listed(tmp_path: Path, name: str, text: str) -> None:
    """A turn under another name is not lost in silence."""
    found = read_placements(written(tmp_path, name, text), TYPES, y_up=False)
    assert found.unused == ("rotation_y", "layer")
    assert found.turn_xyzw.tolist() == [[0.0, 0.0, 0.0, 1.0]]


def test_lines_are_those_of_the_file_beside_comments(tmp_path: Path) -> None:
    """The bad row stands on line 5, behind two comments."""
    text = "# made by hand\ntype,x,y,z\nrock,1,2,3\n# far\nrock,1,two,3\n"
    with pytest.raises(InputError, match=r"a\.csv:5: expected a number"):
        read_placements(written(tmp_path, "a.csv", text), TYPES, y_up=False)
