"""MangoHud's logs, whose unit changed from 0.6.8 to 0.6.9."""

from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.formats.mangohud import read_mangohud
from lodbench.traces.logs.log_checks import check_log
from lodbench.traces.logs.read_log import log_format_of

SYSTEM = "os,cpu,gpu,ram,kernel,driver,cpuscheduler\nArch,Ryzen,RX 6800,32,6.1,Mesa 23,schedutil\n"
HEADER = "fps,frametime,cpu_load,gpu_load,elapsed\n"


def log_file(tmp_path: Path, text: str) -> Path:
    """Write a file of this text."""
    path = tmp_path / "game.csv"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(("unit", "said"), [(1.0, "in ms"), (1000.0, "in us")])
def test_the_unit_is_the_one_in_which_fps_times_frametime_is_a_second(
    tmp_path: Path, unit: float, said: str
):
    """Microseconds of old versions and milliseconds of new ones are the same frame times."""
    rows = "".join(f"{1000 / t:.4f},{t * unit},50,90,{i * 10**7}\n" for i, t in enumerate((10, 20)))
    path = log_file(tmp_path, SYSTEM + HEADER + rows)
    assert log_format_of(path) == "mangohud"
    log = read_mangohud(path)
    assert log.time("frame_ms").tolist() == [10.0, 20.0]
    assert said in log.notes[0]
    assert log.predictors == ()
    assert log.time_s is not None
    assert log.time_s.tolist() == [0.0, 0.01]
    assert ("gpu", "RX 6800") in log.header


def test_versioned_logs_have_titles_above_the_system(tmp_path: Path):
    """With log_versioning the version is read and the header found all the same."""
    text = (
        "v1\n0.7.1\n---------------------SYSTEM INFO---------------------\n"
        + SYSTEM
        + "--------------------FRAME METRICS--------------------\n"
        + HEADER
        + "100,10,50,90,0\n"
    )
    log = read_mangohud(log_file(tmp_path, text))
    assert len(log) == 1
    assert ("version", "0.7.1") in log.header


def test_files_without_frametime_have_fps(tmp_path: Path):
    """Version 0.5 logged fps alone."""
    log = read_mangohud(log_file(tmp_path, SYSTEM + "fps,cpu_load\n50,10\n0,10\n"))
    assert log.time("frame_ms").tolist() == [20.0, float("inf")]


def test_a_log_at_intervals_is_recognised_as_sampled(tmp_path: Path):
    """Rows 100 ms apart with frames of 4 ms cover 4 % of the time."""
    rows = "".join(f"250,4,50,90,{i * 10**8}\n" for i in range(300))
    findings = check_log(read_mangohud(log_file(tmp_path, SYSTEM + HEADER + rows)))
    sampled = [finding for finding in findings if finding.kind == "sampled"]
    assert len(sampled) == 1
    assert "4.0%" in sampled[0].message


def test_summaries_and_files_without_a_header_are_refused(tmp_path: Path):
    """A summary holds no frames, and a description alone holds no log."""
    with pytest.raises(InputError, match="got MangoHud's summary"):
        read_mangohud(log_file(tmp_path, "0.1% Min FPS,1% Min FPS,Average FPS\n1,2,3\n"))
    with pytest.raises(InputError, match="header that begins with fps"):
        read_mangohud(log_file(tmp_path, SYSTEM))
    with pytest.raises(InputError, match="rows below the header, got none"):
        read_mangohud(log_file(tmp_path, SYSTEM + HEADER))
