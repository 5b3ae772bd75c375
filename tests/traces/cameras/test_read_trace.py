"""Recognising formats, and what readers do with any bytes at all."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.traces.cameras.generators.generate import generate
from lodbench.traces.cameras.read_trace import FORMATS, format_of, read_trace, split_spec
from lodbench.traces.cameras.write_trace import write_trace

HEADSET = "FrameNumber,HMDPX,HMDPY,HMDPZ,HMDRX,HMDRY,HMDRZ,Participant,Dataset,ViewFrame\n"

WITH_EXAMPLE = ("csv", "parquet", "tum", "euroc", "kitti", "headset")


@pytest.fixture(scope="module")
def valid(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Make a small valid file of each format."""
    folder = tmp_path_factory.mktemp("valid")
    trace = generate("walk", duration_s=0.2)
    files: dict[str, bytes] = {}
    for name in ("csv", "parquet", "tum"):
        write_trace(trace, folder / name, name)
        files[name] = (folder / name).read_bytes()
    stamps = [1403715524907143168 + 5_000_000 * i for i in range(5)]
    files["euroc"] = "".join(f"{t},{i},0,1,1,0,0,0,0,0\n" for i, t in enumerate(stamps)).encode()
    files["kitti"] = "".join(f"1 0 0 {i} 0 1 0 0 0 0 1 0\n" for i in range(5)).encode()
    rows = "".join(f"{i},0,1.7,0,{i},350,0,P1,H1,{i}\n" for i in range(1, 6))
    files["headset"] = (HEADSET + rows).encode()
    return files


@pytest.mark.parametrize("name", WITH_EXAMPLE)
def test_content_decides_the_format(tmp_path: Path, valid: dict[str, bytes], name: str) -> None:
    """Each format is recognised under a name that says nothing, and read."""
    (tmp_path / "times.txt").write_text("0\n1\n2\n3\n4\n")
    path = tmp_path / "trace.data"
    path.write_bytes(valid[name])
    assert format_of(path) == name
    assert len(read_trace(str(path))) >= 5


def test_selector_follows_the_last_hash(tmp_path: Path) -> None:
    """A file whose name holds ``#`` is itself, anything else is split at the last one."""
    odd = tmp_path / "a#b.csv"
    odd.write_text("x")
    assert split_spec(str(odd)) == (odd, None)
    assert split_spec(f"{odd}#P1") == (odd, "P1")
    assert split_spec("h.csv#P1/H1") == (Path("h.csv"), "P1/H1")
    assert split_spec("h.csv") == (Path("h.csv"), None)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "empty file"),
        (b"\x7fELF\0\0\0", "a zero byte"),
        (b"1 2 3\nP\xe9\n", "a:2: expected UTF-8 text, got byte 0xe9"),
        (b"1 2 3\n4 5 6\n", r"known format .*, got '1 2 3'"),
        (b"# only a comment\n", "got 'no data'"),
        (b"PAR1 and nothing more", "expected a Parquet file that can be read"),
    ],
)
def test_files_of_no_format_are_refused(tmp_path: Path, data: bytes, message: str) -> None:
    """Empty, binary, Latin-1 and unknown files each say what they are."""
    path = tmp_path / "a"
    path.write_bytes(data)
    with pytest.raises(InputError, match=message):
        read_trace(str(path))


@pytest.mark.parametrize("spec", ["absent.csv", ".", "absent.csv#P1", "a\0b"])
@pytest.mark.parametrize("format_name", [None, *FORMATS])
def test_what_is_no_file_is_refused(spec: str, format_name: str | None) -> None:
    """A missing file, a folder and a name with a zero byte are bad input in any format."""
    with pytest.raises(InputError):
        read_trace(spec, format_name)


def test_unknown_format_lists_the_known() -> None:
    """A misspelt format names those that exist."""
    with pytest.raises(
        InputError, match=r"format: expected one of csv, parquet, .*, got tumm; did you mean tum"
    ):
        read_trace("a.txt", "tumm")


def read_or_refuse(path: Path, name: str | None) -> None:
    """Read the file: what comes out is a trace or an `InputError` of one line."""
    try:
        trace = read_trace(str(path), name)
    except InputError as error:
        message = str(error)
    else:
        message = trace.name
    assert message
    assert "\n" not in message


@pytest.mark.parametrize("name", [None, *FORMATS])
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(data=st.binary(max_size=200) | st.text(alphabet="0123456789.,# \ne-naif", max_size=200))
def test_any_bytes_are_a_trace_or_bad_input(
    tmp_path: Path, name: str | None, data: bytes | str
) -> None:
    """Random bytes and random near-numbers never end in another exception."""
    path = tmp_path / "fuzz"
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    read_or_refuse(path, name)


@pytest.mark.parametrize("name", WITH_EXAMPLE)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(draw=st.data())
def test_damaged_files_are_a_trace_or_bad_input(
    tmp_path: Path, valid: dict[str, bytes], name: str, draw: st.DataObject
) -> None:
    """Valid files cut short, with bytes replaced, or with a number made extreme."""
    data = valid[name]
    at = draw.draw(st.integers(0, len(data)))
    patch = draw.draw(
        st.binary(max_size=4) | st.sampled_from([b"1e308", b"-1e308", b"5e-324", b"nan"])
    )
    rest = data[at + draw.draw(st.integers(0, 8)) :] if draw.draw(st.booleans()) else b""
    (tmp_path / "times.txt").write_text("0\n1\n2\n3\n4\n")
    path = tmp_path / "fuzz"
    path.write_bytes(data[:at] + patch + rest)
    read_or_refuse(path, name)
