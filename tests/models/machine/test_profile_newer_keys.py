"""Keys of hardware profiles that are newer than the schema: knees, scatter, slow states, spikes."""

import re
import tomllib
from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.models.machine.identification import Identification
from lodbench.models.machine.knee import Knee
from lodbench.models.machine.profile_file import parse_profile
from lodbench.models.machine.profile_writer import profile_toml
from lodbench.models.machine.residual import Residual
from lodbench.models.machine.scatter import Scatter

MINIMAL = Path(__file__).with_name("minimal.toml").read_text(encoding="utf-8")

NEWER = """
[[gpu.knee]]
predictor = "triangles"
at = 158000.0
value = 100.0
unit = "ns"

[gpu.residual]
kind = "gaussian"
scale = 0.05
slow_scale = 0.04
slow_time_s = 3.0
spike_share = 0.002
spike_scale = 0.5

[gpu.scatter]
occasion = 0.09
assumed = true

[gpu.scatter.scenes]
triangles = 0.25

[gpu.posterior]
terms = ["base", "triangles", "knee(triangles,158000)"]
unit = "ms"
draws = [[0.5, 1e-4, 2e-4], [0.5, 1e-4, 3e-4]]
scale = [0.05, 0.06]

[identification]
condition = 12.0

[identification.variance_share]
triangles = 0.8
"knee(triangles,158000)" = 0.2
"""


def test_knees_scatter_slow_states_and_spikes_are_read():
    """100 ns a triangle beyond 158,000 are 1e-4 ms, and a draw has its own price of it."""
    profile = parse_profile(MINIMAL + NEWER)
    assert profile.gpu.knees == (Knee("triangles", 158000.0, 1e-4),)
    assert profile.gpu_residual == Residual(
        "gaussian", 0.05, slow_scale=0.04, slow_time_s=3.0, spike_share=0.002, spike_scale=0.5
    )
    assert profile.scatter == Scatter(0.09, {"triangles": 0.25}, assumed=True)
    assert profile.identification == Identification(
        12.0, {"triangles": 0.8, "knee(triangles,158000)": 0.2}
    )
    assert profile.posterior is not None
    assert profile.posterior.knee_ms is not None
    assert profile.posterior.knee_ms.tolist() == [[2e-4], [3e-4]]


def test_what_is_newer_is_not_written_where_it_says_nothing():
    """A profile without knees, scatter, slow state and spikes is written as it was before them."""
    written = tomllib.loads(profile_toml(parse_profile(MINIMAL)))
    assert set(written) == set(tomllib.loads(MINIMAL)) | {"frames_in_flight"}
    assert set(written["gpu"]) == {"base", "linear", "residual"}
    assert set(written["gpu"]["residual"]) == {"kind", "scale", "dof", "floor", "correlation"}


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('predictor = "triangles"', 'predictor = "trinagles"', "expected a predictor among"),
        ("at = 158000.0", "at = -1.0", "knee at: expected a finite number >= 0, got -1.0"),
        ("at = 158000.0", "", "expected the key at, found none"),
        ("value = 100.0", "value = inf", "expected a finite number >= 0, got inf"),
        ("[[gpu.knee]]", "[gpu.knee]", "gpu.knee: expected tables, each"),
        ("slow_scale = 0.04", "slow_scale = 4.0", "slow_scale from 0.0 to 1.0, got 4.0"),
        ("slow_time_s = 3.0", "slow_time_s = 0.0", "slow_time_s from 0.01 to"),
        ("spike_share = 0.002", "spike_share = 2.0", "spike_share from 0.0 to 1.0, got 2.0"),
        ("spike_scale = 0.5", "spike_scale = nan", "spike_scale from 0.0 to 1000.0, got nan"),
        ("occasion = 0.09", "occasion = 9", "scatter occasion: expected a log-sd from 0 to 3"),
        ("triangles = 0.25", "trinagles = 0.25", "scatter: expected terms among base"),
        ("triangles = 0.25", "triangles = -1.0", "scatter triangles: expected a log-sd"),
        ("condition = 12.0", "condition = 0.5", "expected condition >= 1, got 0.5"),
        ("triangles = 0.8", "triangles = nan", "identification triangles: expected a finite"),
        ("knee(triangles,158000)", "knee(triangles,9)", "knee"),
    ],
)
def test_broken_knees_scatter_and_states_are_refused(old: str, new: str, says: str):
    """Each mistake in what is newer is told, most of them with their line."""
    assert old in NEWER
    with pytest.raises(InputError, match=re.escape(says)):
        parse_profile(MINIMAL + NEWER.replace(old, new, 1))


def test_knees_are_each_given_once():
    """Two knees of one predictor at one place would be one knee whose price nobody can tell."""
    knee = NEWER.split("[gpu.residual]", maxsplit=1)[0]
    with pytest.raises(InputError, match="expected each knee once, got knee") as told:
        parse_profile(MINIMAL + knee + knee)
    assert told.value.line == (MINIMAL + knee + knee).splitlines().index("[[gpu.knee]]") + 1 + 7
