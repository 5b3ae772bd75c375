"""Hardware profiles as TOML: what is read, what is refused, and that nothing is lost."""

import dataclasses
import tomllib
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from lodbench.models.machine.cost import CostModel, CpuCostModel
from lodbench.models.machine.hardware import Display, HardwareProfile, Posterior, Provenance
from lodbench.models.machine.identification import Identification
from lodbench.models.machine.knee import Knee
from lodbench.models.machine.profile_file import parse_profile, read_profile
from lodbench.models.machine.profile_writer import profile_toml, write_profile
from lodbench.models.machine.residual import Residual
from lodbench.models.machine.scatter import SCATTERED, Scatter

MINIMAL = Path(__file__).with_name("minimal.toml").read_text(encoding="utf-8")

amounts = st.floats(0.0, 1e6)
sparse = st.sampled_from([0.0, 0.0, 1.0]) | st.floats(0.0, 1e3, allow_subnormal=True)


def coefficients(count: int) -> st.SearchStrategy[list[float]]:
    """As many coefficients, some of them 0."""
    return st.lists(sparse, min_size=count, max_size=count)


residuals = st.builds(
    Residual,
    kind=st.sampled_from(["none", "gaussian", "student-t", "lognormal"]),
    scale=st.floats(0.0, 1.0),
    dof=st.floats(0.1, 1e3),
    floor=st.floats(0.0, 1.0),
    correlation=st.floats(0.0, 0.99),
    slow_scale=st.just(0.0) | st.floats(0.0, 1.0),
    slow_time_s=st.just(1.0) | st.floats(0.01, 1e6),
    spike_share=st.just(0.0) | st.floats(0.0, 1.0),
    spike_scale=st.just(0.0) | st.floats(0.0, 1e3),
)
scatters = st.just(Scatter()) | st.builds(
    Scatter,
    st.floats(0.0, 3.0),
    st.dictionaries(st.sampled_from(SCATTERED), st.floats(0.0, 3.0), max_size=4),
    assumed=st.booleans(),
)
identifications = st.none() | st.builds(
    Identification,
    st.floats(1.0),
    st.dictionaries(st.text(max_size=20), st.floats(allow_nan=False, allow_infinity=False)),
)
knees = st.lists(
    st.builds(Knee, st.sampled_from(GPU_PREDICTORS), st.floats(0.0, 1e12), amounts),
    max_size=3,
    unique_by=lambda knee: knee.name,
)
displays = st.builds(
    Display,
    mode=st.sampled_from(["immediate", "vsync", "mailbox", "vrr"]),
    refresh_hz=st.floats(48.0, 360.0),
    vrr_min_hz=st.floats(1.0, 48.0),
    images=st.sampled_from([2, 3]),
    width_px=st.integers(1, 16384),
    height_px=st.integers(1, 16384),
)


@st.composite
def posteriors(draw: st.DrawFn, knee_count: int) -> Posterior:
    """One to four draws."""
    count = draw(st.integers(1, 4))
    rows = [draw(coefficients(len(GPU_PREDICTORS))) for _ in range(count)]
    scale = draw(st.lists(st.floats(0.0, 1.0), min_size=count, max_size=count))
    base = draw(st.lists(amounts, min_size=count, max_size=count))
    knee = [[draw(st.floats(1e-9, 1.0)) for _ in range(knee_count)] for _ in range(count)]
    knee_ms = np.array(knee) if knee_count and draw(st.booleans()) else None
    return Posterior(np.array(base), np.array(rows), np.array(scale), knee_ms=knee_ms)


@st.composite
def with_draws(draw: st.DrawFn, plain: st.SearchStrategy[HardwareProfile]) -> HardwareProfile:
    """Draw a profile, and perhaps draws of its coefficients, of its knees among them."""
    profile = draw(plain)
    drawn = draw(st.none() | posteriors(len(profile.gpu.knees)))
    return dataclasses.replace(profile, posterior=drawn)


profiles = st.builds(
    HardwareProfile,
    name=st.text(),
    provenance=st.builds(
        Provenance,
        st.text(),
        st.text(),
        st.text(),
        st.text(),
        assumed=st.booleans(),
        measured_on=st.lists(st.text(), max_size=3).map(tuple),
    ),
    gpu=st.builds(
        CostModel,
        amounts,
        coefficients(len(GPU_PREDICTORS)),
        coefficients(len(GPU_PREDICTORS)),
        knees.map(tuple),
    ),
    cpu=st.builds(CpuCostModel, amounts, coefficients(len(CPU_PREDICTORS))),
    gpu_residual=residuals,
    cpu_residual=residuals,
    display=displays,
    frames_in_flight=st.integers(1, 4),
    memory_bytes=st.floats(1.0, 1e15),
    disk_bytes_per_s=st.floats(1.0, 1e12),
    disk_latency_ms=st.floats(0.0, 1e6),
    scatter=scatters,
    identification=identifications,
)


def flat(record: Any) -> Any:
    """Show records as dicts and arrays as lists, so that == compares every bit of every field."""
    if dataclasses.is_dataclass(record):
        return {item.name: flat(getattr(record, item.name)) for item in dataclasses.fields(record)}
    if isinstance(record, tuple):
        return list(map(flat, cast("tuple[Any, ...]", record)))
    return record.tolist() if isinstance(record, np.ndarray) else record


@given(with_draws(profiles))
def test_a_profile_read_back_is_the_profile_written(profile: HardwareProfile):
    """Nothing is rounded, renamed or lost on the way through the text."""
    text = profile_toml(profile)
    again = parse_profile(text)
    assert flat(again) == flat(profile)
    assert profile_toml(again) == text


def test_units_become_milliseconds():
    """29.3 ns and 2 µs are 29.3e-6 and 2e-3 ms, and what is left out has its default."""
    profile = parse_profile(MINIMAL)
    linear = dict(zip(GPU_PREDICTORS, profile.gpu.linear_ms.tolist(), strict=True))
    assert linear["triangles"] == 29.3 / 1e6
    assert linear["draw_calls"] == 2.0 / 1e3
    assert profile.gpu.base_ms == 0.5
    assert profile.display == Display(mode="vsync", images=2)
    assert profile.frames_in_flight == 2
    assert profile.posterior is None


def test_draws_of_a_roofline_go_through_the_file():
    """A fit of max(triangles, samples) keeps its draws of both sides, and only then."""
    roofline = np.zeros((2, len(GPU_PREDICTORS)))
    roofline[:, GPU_PREDICTORS.index("triangles")] = 1e-6, 2e-6
    roofline[:, GPU_PREDICTORS.index("shaded_samples")] = 3e-6, 4e-6
    linear = np.zeros((2, len(GPU_PREDICTORS)))
    drawn = Posterior(np.zeros(2), linear, np.ones(2), roofline)
    again = parse_profile(
        profile_toml(dataclasses.replace(parse_profile(MINIMAL), posterior=drawn))
    )
    assert flat(again.posterior) == flat(drawn)
    assert again.truth(1)[0].roofline_ms.tolist() == roofline[1].tolist()


def test_numbers_are_written_in_the_unit_that_reads_best():
    """A coefficient that was given as 29.3 ns is written as 29.3 ns."""
    written = tomllib.loads(profile_toml(parse_profile(MINIMAL)))
    assert written["gpu"]["linear"]["triangles"] == {"value": 29.3, "unit": "ns"}
    assert written["gpu"]["linear"]["draw_calls"] == {"value": 2.0, "unit": "us"}


def test_draws_come_with_their_covariance_and_deviation():
    """Two draws of 1 and 3 have variance 2, and the deviation stands beside the coefficient."""
    linear = np.zeros((2, len(GPU_PREDICTORS)))
    linear[:, GPU_PREDICTORS.index("triangles")] = 1.0, 3.0
    profile = dataclasses.replace(
        parse_profile(MINIMAL), posterior=Posterior(np.zeros(2), linear, np.ones(2))
    )
    written = tomllib.loads(profile_toml(profile))["gpu"]
    assert written["posterior"]["terms"] == ["base", "triangles"]
    assert written["posterior"]["covariance"] == [[0.0, 0.0], [0.0, 2.0]]
    assert written["linear"]["triangles"]["sd"] == pytest.approx(2**0.5 * 1e6, rel=0.01)


@pytest.mark.parametrize(
    ("old", "new", "line", "says"),
    [
        ("hardware/1", "hardware/9", 1, "lodbench.hardware/1"),
        ('unit = "us"', 'unit = "furlong"', 12, "expected one of ns, us, ms, got furlong"),
        ('unit = "us"', "unit = 3", 12, "unit"),
        ("29.3", "-29.3", 11, "gpu.linear.triangles.value: expected a finite number >= 0"),
        ("29.3", "nan", 11, "got nan"),
        ("29.3", "inf", 11, "got inf"),
        ("sd = 0.2", "sd = -1", 11, "gpu.linear.triangles.sd"),
        ("29.3", '"29.3"', 11, "expected float, got str"),
        ("triangles", "trianglez", 11, "did you mean triangles?"),
        ("[disk]", "[disc]", 24, "did you mean disk?"),
        ("images", "imgaes", 19, "did you mean images?"),
        ("images = 2", "images = 5", 17, "display images: expected 2 or 3, got 5"),
        ('mode = "vsync"', 'mode = "vsink"', 18, "immediate, vsync, mailbox, vrr, got vsink"),
        ('source = "hand"\n', "", 4, "expected the key source"),
        ('name = "small"\n', "", None, "expected the key name"),
        ('name = "small"\n', "name = 7\n", 2, "name: expected str, got 7"),
        ('base = { value = 0, unit = "ms" }\n', "", 14, "expected the key base"),
        ("[memory]\nbytes = 1e9\n", "", None, "expected the key memory"),
        ("bytes = 1e9", "bytes = -1", None, "expected positive finite memory"),
        ("[cpu]", "[cpu", 14, "expected TOML"),
        ('name = "small"', "frames_in_flight = true\nname = 'x'", 2, "frames_in_flight"),
        ('name = "small"', "frames_in_flight = 9\nname = 'x'", None, "frames_in_flight"),
        ('source = "hand"', 'source = "hand"\nsource = "x"', 6, "expected TOML"),
        ('source = "hand"', "source = 3", 5, "provenance.source: expected str"),
        ("[gpu]", 'measured_on = "plaza"\n[gpu]', 7, "provenance.measured_on: expected array"),
        ("[gpu]", "measured_on = [7]\n[gpu]", 7, "provenance.measured_on: expected str, got int"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(
    tmp_path: Path, old: str, new: str, line: int | None, says: str
):
    """Each mistake in a profile names the file, the line and what was expected."""
    path = tmp_path / "bad.toml"
    assert old in MINIMAL
    path.write_text(MINIMAL.replace(old, new), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_profile(path)
    assert caught.value.path == str(path)
    assert caught.value.line == line
    assert says in caught.value.message


@pytest.mark.parametrize(
    ("table", "says"),
    [
        ('terms = ["triangles"]\ndraws = [[1.0]]\nscale = [0.1]', "expected base"),
        ('terms = ["base", "base"]\ndraws = [[1.0, 1.0]]\nscale = [0.1]', "distinct"),
        ('terms = ["base", "tris"]\ndraws = [[1.0, 1.0]]\nscale = [0.1]', "got tris"),
        ('terms = ["base"]\ndraws = [[1.0, 2.0]]\nscale = [0.1]', "rows of 1 values"),
        ('terms = ["base"]\ndraws = [[1.0]]\nscale = []', "as many scales"),
        ('terms = ["base"]\ndraws = []\nscale = []', "rows of 1 values"),
        ('terms = ["base"]\ndraws = [[-1.0]]\nscale = [0.1]', ">= 0"),
        ('terms = ["base"]\ndraws = [[nan]]\nscale = [0.1]', "finite"),
        ('terms = ["base"]\ndraws = [["x"]]\nscale = [0.1]', "expected float, got str"),
        (
            'terms = ["base"]\ndraws = [[1.0]]\nscale = [0.1]\ncovariance = [[1.0, 2.0]]',
            "1 finite rows of 1",
        ),
    ],
)
def test_broken_draws_are_refused(table: str, says: str):
    """Draws must be rows of the terms that they name, finite and not negative."""
    text = f'{MINIMAL}\n[gpu.posterior]\nunit = "ms"\n{table}\n'
    with pytest.raises(InputError, match=says):
        parse_profile(text)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path):
    """Latin-1, a directory and an absent file each give one line."""
    latin = tmp_path / "latin.toml"
    latin.write_bytes(MINIMAL.replace("hand", "café").encode("latin-1"))
    with pytest.raises(InputError, match="expected UTF-8 text, got byte 0xe9"):
        read_profile(latin)
    for path in (tmp_path, tmp_path / "absent.toml"):
        with pytest.raises(InputError, match="expected a file that can be read"):
            read_profile(path)


@given(st.text(max_size=60), st.integers(0, len(MINIMAL)))
def test_only_input_errors_come_out_of_damaged_text(noise: str, at: int):
    """Text inserted anywhere gives a profile or an InputError, nothing else."""
    try:
        parse_profile(MINIMAL[:at] + noise + MINIMAL[at:])
    except InputError as error:
        message = str(error)
    else:
        message = ""
    assert "\n" not in message


def test_writing_is_all_or_nothing(tmp_path: Path):
    """A path that cannot be written is an InputError, and leaves no temporary file."""
    profile = parse_profile(MINIMAL)
    path = tmp_path / "out.toml"
    write_profile(profile, path)
    assert flat(read_profile(path)) == flat(profile)
    blocked = tmp_path / "folder"
    blocked.mkdir()
    with pytest.raises(InputError, match="expected a file, got a folder"):
        write_profile(profile, blocked)
    assert sorted(item.name for item in tmp_path.iterdir()) == ["folder", "out.toml"]


def test_the_documented_example_is_a_profile():
    """The file shown in docs/hardware.md is read as it says."""
    page = Path(__file__).parents[3] / "docs" / "hardware.md"
    example = page.read_text(encoding="utf-8").split("```toml\n")[1].split("```")[0]
    profile = parse_profile(example)
    assert profile.name == "my-machine"
    assert profile.gpu.has_roofline
    assert profile.gpu_residual.correlation == 0.9
    assert profile.gpu_residual.slow_time_s == 8.0
    assert profile.gpu.knees == (Knee("triangles", 158000.0, 4e-6),)
    assert profile.scatter == Scatter(0.09, {"triangles": 0.25}, assumed=True)
    assert profile.identification is not None
    assert profile.posterior is not None
    assert len(profile.posterior) == 2
