"""Peng's experiments: stages fitted to what is printed, and the whole at reduced size."""

import numpy as np
import pytest

from lodbench.analysis.fit.log_files import read_log
from lodbench.analysis.reproduce.peng.crowds import INSTANCED, PIPELINE, camera_of
from lodbench.analysis.reproduce.peng.printed import FULL_TRIANGLES, SPEEDUP, TABLE_1, TABLE_2
from lodbench.analysis.reproduce.peng.stages import fit, fit_reformation, fit_stages
from lodbench.analysis.reproduce.registry import find_experiments
from lodbench.analysis.reproduce.reproduce import reproduce
from lodbench.base.errors import InputError
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.traces.cameras.orientation import view_direction


def test_the_printed_table_is_the_bundled_log() -> None:
    """Both were typed from the same page."""
    log = read_log("peng2011")
    triangles = log.counts[:, log.predictors.index("triangles")]
    assert log.gpu_ms is not None
    assert log.gpu_ms.tolist() == [row.rendering_ms for row in TABLE_1]
    assert triangles.tolist() == [row.triangles for row in TABLE_1]


def test_the_profile_is_what_the_stages_fit() -> None:
    """The shipped coefficients come out again, to the digits that the file has."""
    gpu, stages = load_hardware(PIPELINE).gpu, fit_stages()
    bases = stages.selection[0] + stages.reformation[0] + stages.rendering[0]
    assert gpu.base_ms == pytest.approx(bases, rel=1e-5)
    for name, ms in (
        ("triangles", stages.rendering[1]),
        ("reformed_triangles", stages.reformation[1]),
        ("reformed_objects", stages.reformation[2]),
        ("reduction_steps", stages.selection[1]),
    ):
        assert gpu.unit_ms(name) == pytest.approx(ms, rel=1e-5)


def test_the_instanced_profile_has_the_printed_extremes() -> None:
    """1.22 at 32 characters and 5.33 at 8,192, of the printed frames."""
    gpu = load_hardware(INSTANCED).gpu
    for row, speedup in ((TABLE_1[0], SPEEDUP[0]), (TABLE_1[-1], SPEEDUP[1])):
        ms = gpu.base_ms + gpu.unit_ms("triangles") * FULL_TRIANGLES * row.instances
        assert ms / row.frame_ms == pytest.approx(speedup, rel=1e-4)


def test_a_fit_finds_the_law_that_made_the_numbers() -> None:
    """Two coefficients from three rows on a line, and never a negative one."""
    ones, x = np.ones(3), np.array([1.0, 2.0, 4.0])
    assert fit((ones, x), [5.0, 7.0, 11.0]) == pytest.approx([3.0, 2.0])
    assert fit((ones, x), [4.0, 3.0, 2.0])[1] == 0.0


def test_reformation_of_the_larger_crowds_follows_from_table_1() -> None:
    """Within 5 % of the times printed for 16,384 and 32,768, which were not fitted."""
    base, a_triangle, a_character = fit_reformation(TABLE_1)
    for row in TABLE_2[-2:]:
        ms = base + a_triangle * row.triangles + a_character * row.instances
        assert ms == pytest.approx(row.reformation_ms, rel=0.05)


def test_cameras_look_over_the_crowd_and_down() -> None:
    """From the corner along the diagonal, from the edge straight on, 12 degrees down."""
    level = np.cos(np.radians(12.0))
    for place, toward in (("corner", (level / 2**0.5, level / 2**0.5)), ("edge", (0.0, level))):
        camera = camera_of(1_024, place)
        direction = view_direction(camera.orientation_xyzw[0])
        assert direction == pytest.approx((*toward, -np.sin(np.radians(12.0))))
        assert float(direction[:2] @ camera.position_m[0, :2]) < -23.25
    with pytest.raises(InputError, match="expected corner or edge, got roof"):
        camera_of(32, "roof")


@pytest.mark.slow
def test_peng_at_reduced_size() -> None:
    """What holds of three crowds, and what does not hold, with its reason."""
    result = reproduce(find_experiments("peng"), reduced=True, workers=1)
    verdicts = {(entry.id, entry.claim): entry.verdict for entry in result.entries}

    def of(name: str, words: str) -> str:
        (found,) = [v for (i, claim), v in verdicts.items() if i == name and words in claim]
        return found

    table1 = [verdict for (name, _), verdict in verdicts.items() if name == "peng/table1"]
    assert table1 == ["reproduced"] * 6
    for words in ("(calibrated)", "each row left out", "times, predicted from Table 1"):
        assert of("peng/table2", words) == "reproduced"
    assert "0.89 and 0.95" in of("peng/table2", "ratios, predicted from Table 1")
    assert of("peng/table2", "alone") == "in direction"
    assert of("peng/n-rule", "2,048 characters, camera at the edge") == "reproduced"
    assert of("peng/n-rule", "32 characters, camera at the edge").startswith("not reproduced")
    assert of("peng/fig5", "printed times") == of("peng/fig5", "fitted stages") == "reproduced"
    assert "two pipelines" in of("peng/fig5", "as much instanced")
    assert "base of its own" in of("peng/fig5", "least speed-up")
    assert len({(section.experiment.id) for section in result.sections}) == 4
