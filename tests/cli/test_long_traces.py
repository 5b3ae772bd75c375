"""Paths with gaps of years are refused with one line, before anything is replayed."""

from collections.abc import Callable
from pathlib import Path

import pytest

from lodbench.cli.main import run

TEN_YEARS_S = 10 * 365.25 * 86400.0
EPOCH_S = 1_305_031_102.175304  # when the first sequence of TUM's benchmark was recorded

Write = Callable[[Path, list[float]], Path]


def write_tum(folder: Path, times: list[float]) -> Path:
    """Write poses a metre apart, after a line of comment."""
    path = folder / "path.txt"
    rows = (f"{time:.6f} {x} 0 1.7 0 0 0 1" for x, time in enumerate(times))
    path.write_text("\n".join(["# timestamp tx ty tz qx qy qz qw", *rows, ""]), encoding="utf-8")
    return path


def write_kitti(folder: Path, times: list[float]) -> Path:
    """Write matrices without a turn, a metre apart, and their times beside them."""
    path = folder / "poses.txt"
    rows = (f"1 0 0 {x} 0 1 0 0 0 0 1 0" for x in range(len(times)))
    path.write_text("\n".join(["# poses", *rows, ""]), encoding="utf-8")
    (folder / "times.txt").write_text("\n".join(f"{time:.6f}" for time in times), encoding="utf-8")
    return path


def write_csv(folder: Path, times: list[float]) -> Path:
    """Write the native format."""
    path = folder / "path.csv"
    rows = (f"{time:.6f},{x},0,1.7,0,0,0,1" for x, time in enumerate(times))
    path.write_text("\n".join(["time_s,x_m,y_m,z_m,qx,qy,qz,qw", *rows, ""]), encoding="utf-8")
    return path


FORMATS: list[Write] = [write_tum, write_kitti, write_csv]


def refusal(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """Return the one line with which a command refuses its input."""
    capsys.readouterr()
    assert run(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    return captured.err


@pytest.mark.parametrize("write", FORMATS)
@pytest.mark.parametrize("start_s", [0.0, EPOCH_S])
def test_a_gap_of_ten_years_is_refused_at_its_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], write: Write, start_s: float
) -> None:
    """Ten samples, and ten more after ten years: the eleventh stands on the twelfth line."""
    times = [start_s + 0.1 * step + (TEN_YEARS_S if step >= 10 else 0.0) for step in range(20)]
    path = write(tmp_path, times)
    compare = ["compare", "--policy", "full", "--trace", str(path)]
    for arguments in (compare, ["trace", "info", str(path)]):
        assert refusal(arguments, capsys) == (
            f"error: {path}:12: expected poses at most an hour apart, got 3.15576e+08 s "
            "(3.65e+03 days) without one; cut the file there, or correct its times\n"
        )


def test_a_path_of_days_is_refused_where_it_is_too_long(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Half-minutes up to two days are a path; the pose after them is too late."""
    two_days = [30.0 * step for step in range(2 * 24 * 120 + 1)]
    assert run(["trace", "info", str(write_tum(tmp_path, two_days))]) == 0
    path = write_tum(tmp_path, [*two_days, two_days[-1] + 30.0])
    assert refusal(["trace", "info", str(path)], capsys) == (
        f"error: {path}:{len(two_days) + 2}: expected a path of at most 48 hours, got 172830 s "
        "(2 days); cut the file there, or correct its times\n"
    )


@pytest.mark.slow
def test_more_frames_than_a_replay_has_are_refused_before_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """47 hours at 60 Hz are 10,152,000 frames; a stretch of them may be replayed."""
    path = write_tum(tmp_path, [30.0 * step for step in range(47 * 120 + 1)])
    small = ["compare", "--scene", "crowd-32", "--policy", "full", "--workers", "1"]
    small += ["--trace", str(path)]
    assert "expected at most 10000000 frames, got 1.02e+07; replay a stretch of it" in refusal(
        small, capsys
    )
    assert run([*small, "--seconds", "0:2"]) == 0


def test_times_since_1970_are_times(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A path that begins decades after the clock's zero is as long as it is."""
    path = write_tum(tmp_path, [EPOCH_S + 0.1 * step for step in range(20)])
    assert run(["trace", "info", str(path), "--json"]) == 0
    assert '"duration_s": 1.9' in capsys.readouterr().out


@pytest.mark.parametrize(
    ("time", "message"),
    [
        ("1e308", "expected times in seconds, got 1e+308"),
        ("inf", "expected a finite number for timestamp, got 'inf'"),
        ("nan", "expected a finite number for timestamp, got 'nan'"),
        ("-1", "expected times in order, got -1 after 0.9"),
        ("1e999", "expected a finite number for timestamp, got '1e999'"),
    ],
)
def test_times_that_are_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], time: str, message: str
) -> None:
    """Each is refused at its line."""
    path = write_tum(tmp_path, [0.1 * step for step in range(10)])
    path.write_text(f"{path.read_text(encoding='utf-8')}{time} 0 0 0 0 0 0 1\n", encoding="utf-8")
    assert f"{path}:12: {message}" in refusal(["trace", "info", str(path)], capsys)
