"""Damage files of all formats by seed, read each as the command line does, and tell what happened.

    python tests/damaged/damage_run.py --each 145 --results out/damaged.jsonl

Readers run in child processes with limits, one at a time: a child that dies or hangs is one
failure, and the next goes on after it.  What the file of results has is not repeated.
"""

import argparse
import contextlib
import io
import json
import os
import random
import resource
import signal
import sys
import tempfile
import threading
import time
import traceback
import warnings
from collections import Counter, defaultdict
from collections.abc import Callable, Generator, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TextIO, TypeAlias

sys.path.insert(0, str(Path(__file__).parent))

from camera_seeds import camera_seeds
from damage import damage
from log_seeds import log_seeds
from record_seeds import READERS, record_seeds
from scene_seeds import mesh_seeds, placement_seeds, scene_seeds, tileset_seeds
from seed import Seed

Result: TypeAlias = dict[str, Any]
"""What happened to a damaged file: exit code, seconds, peak of memory, what was wrong, the line."""

MOST_S, MOST_BYTES, LONGEST = 2.0, 1 << 30, 300
"""Of processor time and of memory that a file may take, and characters of a line about it."""

_HANG_S, _ADDRESS_BYTES = 60, 6 << 30
_OURS = ("warning: ", "note: ", "error: ")


_MAKERS = (
    *(scene_seeds, tileset_seeds, placement_seeds, mesh_seeds),
    *(record_seeds, log_seeds, camera_seeds),
)


def make_seeds(scratch: Path) -> list[Seed]:
    """Return whole files of all formats, made in an empty folder."""
    with contextlib.redirect_stdout(io.StringIO()):
        return [seed for make in _MAKERS for seed in make(scratch)]


def damaged(seed: Seed, number: int) -> dict[str, bytes]:
    """Return the files of a seed, one of them damaged."""
    rng = random.Random(f"{seed.family}/{seed.name}/{number}")
    name = rng.choice([*seed.kinds, next(iter(seed.kinds))])  # the one that is read is hit twice
    return seed.files | {name: damage(seed.files[name], seed.kinds[name], rng)}


def read_one(seed: Seed, path: Path) -> int:
    """Read a file by its command or its reader, and return the exit code."""
    from lodbench.base.errors import InputError
    from lodbench.cli.main import run

    if seed.command[0] not in READERS:
        return run([str(path) if word == "@" else word for word in seed.command])
    try:
        READERS[seed.command[0]](path)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def judge(code: int, out: str, err: str, seconds: float, peak: int) -> list[str]:
    """Return what was not as it has to be."""
    wrong: list[str] = []
    lines = err.splitlines()
    if code not in (0, 2):
        wrong.append(f"exit code {code}")
    if code == 2 and (not lines or not lines[-1].startswith("error: ")):
        wrong.append("no line of error")
    if sum(line.startswith("error: ") for line in lines) > 1:
        wrong.append("several errors")
    foreign = [line for line in lines if not line.startswith(_OURS)]
    if foreign:
        wrong.append(f"leaked: {foreign[0][:200]}")
    if any(len(line) > LONGEST for line in lines):
        wrong.append(f"a line of {max(map(len, lines))} characters")
    if not all(line.isprintable() for line in (*lines, *out.splitlines())):
        wrong.append("control characters")
    if seconds > MOST_S:
        wrong.append(f"{seconds:.1f} s")
    if peak > MOST_BYTES:
        wrong.append(f"{peak / 2**20:.0f} MiB")
    return wrong


def run_child(seed: Seed, first: int, count: int, report: TextIO, *, scratch: Path) -> None:
    """Read the damaged files of one seed, a line of JSON about each."""
    resource.setrlimit(resource.RLIMIT_AS, (_ADDRESS_BYTES, _ADDRESS_BYTES))
    with tempfile.TemporaryDirectory(dir=scratch) as folder:
        here = Path(folder)
        whole = _read_files(seed, seed.files, here)
        if whole["code"] or whole["wrong"]:
            raise RuntimeError(f"{seed.name}: expected it to be read while whole, got {whole}")
        for number in range(first, first + count):
            print(json.dumps({"begins": number}), file=report, flush=True)
            line = _read_files(seed, damaged(seed, number), here)
            print(json.dumps({"number": number, **line}), file=report, flush=True)
            if line["peak"] > MOST_BYTES:
                return  # where a kernel's peak cannot be set back, it would be told of the next too


def _read_files(seed: Seed, files: dict[str, bytes], here: Path) -> Result:
    os.chdir(here)  # files go by short names, of which messages are full
    for old in here.iterdir():
        old.unlink()
    for name, content in files.items():
        (here / name).write_bytes(content)
    out, err, code, raised = io.StringIO(), io.StringIO(), -1, ""
    with (
        tempfile.TemporaryFile("w+", errors="replace") as leaked,
        _file_two(leaked),
        warnings.catch_warnings(record=True) as warned,
    ):
        warnings.simplefilter("always")  # each, and not only the first of its place in the code
        Path("/proc/self/clear_refs").write_text("5")  # the peak counts anew
        began = time.process_time()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                code = read_one(seed, Path(next(iter(files))))
            except Exception:  # noqa: BLE001 - which ones there are is what is asked
                raised = traceback.format_exc()
        seconds = time.process_time() - began
        leaked.seek(0)
        told = [f"{each.category.__name__}: {each.message}\n" for each in warned]
        texts = "".join((err.getvalue(), leaked.read(), *told))
    wrong = judge(code, out.getvalue(), texts, seconds, _peak_bytes())
    if raised:
        wrong.insert(0, "traceback: " + raised.strip().splitlines()[-1][:200])
    return {
        "code": code,
        "seconds": seconds,
        "peak": _peak_bytes(),
        "wrong": wrong,
        "message": texts[-400:],
        "traceback": raised[-3_000:],
    }


@contextlib.contextmanager
def _file_two(file: Any) -> Generator[None]:
    """Let what native libraries write to stderr go to a file."""
    kept = os.dup(2)
    os.dup2(file.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def _peak_bytes() -> int:
    status = Path("/proc/self/status").read_text(encoding="ascii")
    line = next(line for line in status.splitlines() if line.startswith("VmHWM"))
    return 1024 * int(line.split()[1])


def run_seed(seed: Seed, count: int, scratch: Path, first: int = 0) -> Iterator[Result]:
    """Yield what happened to damaged files of a seed from a first one on, whatever happens."""
    while first < count:
        at = first - 1
        work = partial(run_child, seed, first, count - first, scratch=scratch)
        with _forked(work) as (pid, lines):
            with _watched(pid) as again:
                for line in lines:
                    again()
                    found = json.loads(line)
                    if "begins" in found:
                        at = found["begins"]
                    else:
                        first = found["number"] + 1
                        yield {"family": seed.family, "name": seed.name, **found}
            _, status = os.waitpid(pid, 0)
        if status == 0 and at == first - 1:
            continue
        if at < first:
            raise RuntimeError(f"{seed.name}: the child ended before it had read a file")
        wrong = [f"the process ended with {os.waitstatus_to_exitcode(status)}"]
        nothing = {"code": -1, "seconds": 0.0, "peak": 0, "message": "", "traceback": ""}
        yield {"family": seed.family, "name": seed.name, "number": at, "wrong": wrong, **nothing}
        first = at + 1


@contextlib.contextmanager
def _forked(work: Callable[[TextIO], None]) -> Generator[tuple[int, TextIO]]:
    """Do some work in a copy of this process, which need not import all again; yield its lines."""
    from_child, to_parent = os.pipe()
    with warnings.catch_warnings():
        # Threads of Arrow, which Python 3.12 warns of, do nothing in the copy.
        warnings.simplefilter("ignore", DeprecationWarning)
        pid = os.fork()
    if pid == 0:
        os.close(from_child)
        status = 1
        try:
            with os.fdopen(to_parent, "w", encoding="utf-8") as report:
                work(report)
            status = 0
        except BaseException:  # noqa: BLE001 - the copy must never go on as the original
            traceback.print_exc()
        finally:
            os._exit(status)
    os.close(to_parent)
    with os.fdopen(from_child, encoding="utf-8") as lines:
        yield pid, lines


@contextlib.contextmanager
def _watched(pid: int) -> Generator[Callable[[], None]]:
    """End a child that says nothing for too long; yield what is to be called when it does."""
    timer = threading.Timer(2 * _HANG_S, os.kill, (pid, signal.SIGKILL))
    timer.start()

    def again() -> None:
        nonlocal timer
        timer.cancel()
        timer = threading.Timer(_HANG_S, os.kill, (pid, signal.SIGKILL))
        timer.start()

    try:
        yield again
    finally:
        timer.cancel()


def run_all(scratch: Path, each: int, only: str, known: Sequence[Result] = ()) -> Iterator[Result]:
    """Yield what happens to so many damaged files of each seed, beyond those that are known."""
    done = Counter((result["family"], result["name"]) for result in known)
    seeds = [seed for seed in make_seeds(scratch) if only in f"{seed.family}/{seed.name}"]
    missing = [seed for seed in seeds if done[seed.family, seed.name] < each]
    for seed in {seed.family: seed for seed in missing}.values():
        _read_files(seed, seed.files, scratch)  # what a command imports, children then have
    for seed in missing:
        yield from run_seed(seed, each, scratch, done[seed.family, seed.name])


def table_of(results: list[Result]) -> str:
    """Return a table by family, in Markdown."""
    groups: dict[str, list[Result]] = defaultdict(list)
    for result in results:
        groups[result["family"]].append(result)
    heads = ("files", "seeds", "damaged", "read", "refused", "other", "slowest s", "largest MiB")
    rows = [f"| {' | '.join(heads)} |", f"|---{'|--:' * 7}|"]
    for family, found in (*groups.items(), ("**all**", results)):
        seeds = len({(r["family"], r["name"]) for r in found})
        wrong = sum(bool(r["wrong"]) for r in found)
        read = sum(not r["wrong"] and r["code"] == 0 for r in found)
        slowest, largest = max(r["seconds"] for r in found), max(r["peak"] for r in found)
        rows.append(
            f"| {family} | {seeds} | {len(found):,} | {read:,} | {len(found) - read - wrong:,} "
            f"| {wrong} | {slowest:.1f} | {largest / 2**20:.0f} |"
        )
    return "\n".join(rows)


def main() -> int:
    """Run what the command line asks for; 1 if a file was not as it has to be."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--each", type=int, default=10, help="damaged files of each seed")
    parser.add_argument("--only", default="", help="part of family/name")
    parser.add_argument("--results", type=Path, required=True, help="a line of JSON a file")
    given = parser.parse_args()
    path: Path = given.results
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    results: list[Result] = [json.loads(line) for line in lines]
    with tempfile.TemporaryDirectory() as folder, path.open("a", encoding="utf-8") as file:
        for result in run_all(Path(folder), given.each, given.only, results):
            print(json.dumps(result), file=file, flush=True)
            results.append(result)
            if result["wrong"]:
                told = (result["family"], result["name"], result["number"], *result["wrong"])
                print(*told, sep=" | ", file=sys.stderr)
    print(table_of(results))
    return int(any(result["wrong"] for result in results))


if __name__ == "__main__":
    sys.exit(main())
