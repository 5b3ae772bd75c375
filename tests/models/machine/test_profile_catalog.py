"""The bundled profiles: found by name, and what they state about themselves."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from lodbench.models.machine.profile_catalog import list_hardware, load_hardware
from lodbench.models.machine.profile_writer import write_profile

PROFILES = Path(__file__).parents[3] / "models" / "machine" / "profiles"


def test_every_bundled_profile_loads_under_its_own_name():
    """The name of the file is the name inside it."""
    names = list_hardware()
    assumed = ("athlon64-6800ultra-assumed", "desktop-assumed")
    others = ("quadro5000-2011", "quadro5000-instanced-assumed", "thesis-m30-assumed")
    assert names == (*assumed, "geforce2go-2002", "llvmpipe", *others)
    assert [load_hardware(name).name for name in names] == list(names)


def test_a_path_loads_too(tmp_path: Path):
    """A profile written elsewhere is found by its path."""
    path = tmp_path / "mine.toml"
    write_profile(load_hardware("llvmpipe"), path)
    assert load_hardware(str(path)).name == "llvmpipe"


def test_an_unknown_name_suggests_the_nearest():
    """A misspelt name lists what there is and the likeliest."""
    with pytest.raises(InputError, match="did you mean llvmpipe"):
        load_hardware("llvmpip")
    with pytest.raises(InputError, match="expected a file that can be read"):
        load_hardware("nowhere.toml")


def test_zach_2002_has_exactly_the_constants_printed():
    """Splat 0.35 µs, tree 2.45 µs, vertex 0.06 µs of graphics; selection by remarks of theirs."""
    profile = load_hardware("geforce2go-2002")
    linear = dict(zip(GPU_PREDICTORS, profile.gpu.linear_ms.tolist(), strict=True))
    charged = {name: value for name, value in linear.items() if value}
    printed = {"splats": 0.35e-3, "draw_calls": 2.45e-3, "vertices": 0.06e-3}
    assert charged == pytest.approx(printed, rel=1e-15)
    assert profile.gpu.base_ms == profile.cpu.base_ms == 0.0
    processor = dict(zip(CPU_PREDICTORS, profile.cpu.linear_ms.tolist(), strict=True))
    assert {name for name, ms in processor.items() if ms} == {"comparisons", "objects_culled"}
    assert 1.5 < 74_238 * processor["objects_culled"] < 2.0  # "usually less than 2ms"
    # Their budget of 100 ms buys 1,000 trees of 250 splats and a strip of 166,666 vertices.
    cost = 1_000 * (linear["draw_calls"] + 250 * linear["splats"]) + 166_666 * linear["vertices"]
    assert cost == pytest.approx(99.95, abs=0.01)


def test_the_assumed_profile_says_so_and_others_do_not():
    """Only profiles with assumed costs carry the mark; names say so where all costs are."""
    marked = [name for name in list_hardware() if load_hardware(name).provenance.assumed]
    all_assumed = [
        *("athlon64-6800ultra-assumed", "desktop-assumed"),
        *("quadro5000-instanced-assumed", "thesis-m30-assumed"),
    ]
    assert sorted(set(marked) - {"geforce2go-2002"}) == all_assumed
    assert "geforce2go-2002" in marked  # what selection takes on its processor
    assert [name for name in list_hardware() if name.endswith("-assumed")] == all_assumed


def test_every_number_of_an_assumed_profile_has_its_source_on_the_line():
    """A coefficient in an assumed profile is marked assumed, or says who measured or printed it."""
    for name, count in (
        ("desktop-assumed", 2 + 9 + len(CPU_PREDICTORS) - 1),  # the GPU alone pays for uploads
        ("athlon64-6800ultra-assumed", 2 + 2 + 3),
        ("thesis-m30-assumed", 2 + 3 + 2),
    ):
        _assert_sourced((PROFILES / f"{name}.toml").read_text(encoding="utf-8"), count)


def _assert_sourced(text: str, count: int) -> None:
    amounts = [line for line in text.splitlines() if "unit =" in line]
    assert len(amounts) == count
    for line in amounts:
        assert any(word in line for word in ("assumed", "printed", "CesiumJS", "Peng")), line


def test_the_assumed_desktop_is_overloaded_by_a_full_crowd():
    """3,000 objects of 3,000 triangles at full detail take 2 to 4 frames of 60 Hz, a tenth fits."""
    gpu = load_hardware("desktop-assumed").gpu
    cost = dict(zip(GPU_PREDICTORS, gpu.linear_ms.tolist(), strict=True))
    fixed = gpu.base_ms + 1920 * 1080 * cost["framebuffer_pixels"] + 4 * cost["state_changes"]
    full = fixed + 3_000 * (cost["draw_calls"] + 3_000 * cost["triangles"])
    tenth = fixed + 3_000 * (cost["draw_calls"] + 300 * cost["triangles"])
    assert 2.0 < full / (1e3 / 60) < 4.0
    assert tenth < 1e3 / 60


def test_the_measured_profile_carries_draws_about_its_coefficients():
    """The coefficients of llvmpipe lie inside the spread of their own draws."""
    profile = load_hardware("llvmpipe")
    draws = profile.posterior
    assert draws is not None
    assert len(draws) == 64
    assert profile.frames_in_flight == 1
    low, high = np.quantile(draws.linear_ms, [0.05, 0.95], axis=0)
    assert ((low <= profile.gpu.linear_ms) & (profile.gpu.linear_ms <= high)).all()
