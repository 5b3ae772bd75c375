"""`lodbench fit` on captures of engines and tools that cannot be fitted: each says why."""

from pathlib import Path

import pytest

from lodbench.cli.main import run


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("threejs-pirateconquest-large_battle.csv", "tied to a clock of 59.97 Hz"),
        ("ocat-metroexodus.csv", "predictors draw_calls, vertices, triangles"),
        ("capframex-with-header.csv", "predictors draw_calls, vertices, triangles"),
        ("presentmon-v2.csv", "predictors draw_calls, vertices, triangles"),
        ("chrometrace-perfetto-flow.json", "expected a render log, got Chrome trace events"),
    ],
)
def test_real_logs_that_cannot_be_fitted_say_why(
    data_dir: Path, name: str, says: str, capsys: pytest.CaptureFixture[str]
):
    """Capped times carry no cost; timings alone have no predictors, and the missing are named."""
    assert run(["fit", str(data_dir / "logs" / name)]) == 2
    printed = capsys.readouterr().err
    assert printed.startswith("error: ")
    assert printed.count("\n") == 1
    assert says in printed


@pytest.mark.realdata
def test_a_software_rasterisers_timer_is_refused(
    data_dir: Path, capsys: pytest.CaptureFixture[str]
):
    """Asked for by name, gpu_ms of llvmpipe is refused with its reason."""
    path = data_dir / "logs" / "llvmpipe-random-a.csv"
    assert run(["fit", str(path), "--target", "gpu_ms"]) == 2
    assert "software rasteriser's timer" in capsys.readouterr().err
