"""Which column of a log is which predictor or time.

What is mapped (``gpu_ms=GPUTime``, ``gpu_ms=span:us``) goes before what the words of the names say
(`columns.column_roles`).  A column serves one name.  Where names leave a choice that matters, none
is made: the columns are named, with the mapping that would make it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ...base.errors import InputError
from ...base.nearest_names import unknown_name
from .columns.column_roles import PARTS, ROLES, THREADS, role_of, said_by, smell_of
from .columns.column_words import words_of
from .render_log import COUNTS, RECORDED, TIMES

MS_PER = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}
TIMED = (*TIMES, "time_s")
NAMES = tuple(dict.fromkeys((*(name for name in ROLES if name != "fps"), *COUNTS)))
"""All that a column can be mapped to."""

_MULTIPLIERS = {"k": 1e3, "M": 1e6}


@dataclass(frozen=True, slots=True)
class LogColumn:
    """A column of a log under the name that lodbench gives it.

    Attributes
    ----------
    unit : of times only: "ns", "us", "ms", "s", or "" where neither name nor mapping has one
    multiplier : of counts, as 1e6 of ``Triangles (M)``
    stated : whether the user gave the unit or the multiplier
    """

    name: str
    index: int
    source: str
    unit: str
    multiplier: float = 1.0
    stated: bool = False


@dataclass(frozen=True, slots=True)
class FoundColumns:
    """What a header holds.

    Attributes
    ----------
    columns : the known ones; several of ``cpu_ms`` are threads, of which the longest counts
    notes : what was left aside, one sentence each
    unused : (index, name) of all others
    """

    columns: tuple[LogColumn, ...]
    notes: tuple[str, ...]
    unused: tuple[tuple[int, str], ...]


MOST_COLUMNS = 4096
"""No tool writes more; Unreal, with everything on, writes some 400."""


@dataclass(frozen=True, slots=True)
class _Header:
    names: Sequence[str]
    path: Path
    line: int | None
    twins: bool

    def error(self, message: str) -> InputError:
        return InputError(message, path=self.path, line=self.line)


def find_columns(
    header: Sequence[str],
    mapping: Mapping[str, str] | None,
    *,
    path: Path,
    line: int | None,
    twins: bool = False,
) -> FoundColumns:
    """Return the columns of a log that are known or mapped, and what was left aside.

    `line` is that of the header; `twins` says that a tool repeats names, so that the first of a
    name is taken.

    Raises `InputError` if the mapping names what does not exist or one column for two names, a
    column that is needed stands twice, or none holds a time or is a clock.
    """
    head = _Header(header, path, line, twins)
    if len(header) > MOST_COLUMNS:
        raise head.error(f"expected at most {MOST_COLUMNS} columns, got {len(header)}; drop some")
    found = _mapped(mapping or {}, head)
    mapped = {column.index for column in found}
    found += [
        LogColumn(name, index, name, "ms" if name.endswith("_ms") else "")
        for index, name in enumerate(header)
        if name in RECORDED and header.count(name) == 1 and index not in mapped
    ]
    named = {column.name for column in found}
    notes: list[str] = []
    for name, ranked in _candidates(header, {column.index for column in found}).items():
        if name not in named and name != "fps":
            found += _chosen(name, ranked, head, notes)
        elif name == "fps" and not any(column.name in TIMES for column in found):
            index = ranked[0][1]
            found.append(LogColumn("frame_ms", index, header[index], "fps"))
    if not any(column.name in TIMED for column in found):
        raise no_time(header, path, line)
    taken = {column.index for column in found}
    found += [
        LogColumn(name, index, name, "")
        for index, name in enumerate(header)
        if _of_type(name) and header.count(name) == 1 and index not in taken
    ]
    taken = {column.index for column in found}
    unused = tuple((index, name) for index, name in enumerate(header) if index not in taken)
    return FoundColumns(tuple(found), tuple(notes), unused)


def _candidates(
    header: Sequence[str], taken: set[int]
) -> dict[str, list[tuple[tuple[int, int, int], int]]]:
    """Return the columns that could have each role, best first, each with its rank.

    Frame rates come last: they serve where there is no time.
    """
    candidates: dict[str, list[tuple[tuple[int, int, int], int]]] = {}
    for index, name in enumerate(header):
        role = None if index in taken or _of_type(name) else role_of(name)
        if role is not None:
            rank = (int(bool(role[2])), role[1], len(role[2]))
            candidates.setdefault(role[0], []).append((rank, index))
    order = sorted(candidates, key=lambda name: (name == "fps", list(ROLES).index(name)))
    return {name: sorted(candidates[name]) for name in order}


def _of_type(name: str) -> bool:
    """Return whether a column holds one type's part of a count, such as ``triangles[tree]``."""
    return name.endswith("]") and name.partition("[")[0] in COUNTS


def _chosen(
    name: str,
    ranked: list[tuple[tuple[int, int, int], int]],
    head: _Header,
    notes: list[str],
) -> list[LogColumn]:
    """Return the column of a role among those that could be it, or the threads; none in doubt."""
    header = head.names
    clean = [index for rank, index in ranked if not rank[0]]
    threads = [i for i in clean if name == "cpu_ms" and said_by(header[i]) & THREADS]
    threads = [
        i for place, i in enumerate(threads) if header[i] not in _of(header, threads[:place])
    ]
    whole = [index for index in clean if not said_by(header[index]) & THREADS or name != "cpu_ms"]
    if threads and not whole:
        listed = ", ".join(header[i] for i in threads)
        if len(threads) > 1:
            notes.append(f"{name} is the longest of {listed}")
        return [_column(name, i, head) for i in threads]
    if not clean:
        open_to = [i for _, i in ranked if not said_by(header[i]) & PARTS]
        if len(open_to) != 1:
            listed = ", ".join(header[i] for _, i in ranked[:4])
            choice = f"--map {name}={header[ranked[0][1]]}"
            notes.append(f"no {name}: which of {listed} is meant, if any, {choice} would say")
            return []
        clean = open_to
    chosen = (whole or clean)[0]
    others = list(dict.fromkeys(header[i] for _, i in ranked if header[i] != header[chosen]))
    if others:
        shown = ", ".join(others[:6]) + (", …" if len(others) > 6 else "")
        notes.append(f"{name} is {header[chosen]}; {shown} left aside")
    return [_column(name, chosen, head)]


def _of(header: Sequence[str], places: Sequence[int]) -> list[str]:
    return [header[place] for place in places]


def _column(name: str, index: int, head: _Header) -> LogColumn:
    source = head.names[index]
    words = words_of(source)
    if head.names.count(source) > 1:
        if not head.twins:
            message = f"expected one column {source}, got {head.names.count(source)}"
            raise head.error(f"{message}; rename or remove one")
        index = head.names.index(source)
    if name in TIMED:
        return LogColumn(name, index, source, words.unit)
    return LogColumn(name, index, source, "", words.multiplier)


def no_time(header: Sequence[str], path: Path, line: int | None) -> InputError:
    """Return the error about columns of which none is a time, with the mapping that would help."""
    shown = ", ".join(header[:12]) + (", …" if len(header) > 12 else "")
    likely = next((name for name in header if smell_of(name) == "time"), "NAME")
    message = f"expected a column with a time ({', '.join(TIMES)}), got {shown[:120]}"
    advice = f"map one, such as --map gpu_ms={likely}"
    return InputError(f"{message}; {advice}", path=path, line=line)


def _mapped(mapping: Mapping[str, str], head: _Header) -> list[LogColumn]:
    found: list[LogColumn] = []
    for name, given in mapping.items():
        if name not in NAMES:
            raise InputError(f"mapping: {unknown_name(name, NAMES)}")
        source, suffix = _unit_apart(name, given, head)
        index, words = head.names.index(source), words_of(source)
        twice = next((column.name for column in found if column.index == index), None)
        if twice is not None:
            message = f"expected a column to serve one name, got {source} for {twice} and {name}"
            raise InputError(f"mapping: {message}; map another", path=head.path, line=head.line)
        if name in TIMED:
            found.append(LogColumn(name, index, source, suffix or words.unit, stated=bool(suffix)))
        else:
            multiplier = _MULTIPLIERS.get(suffix, words.multiplier)
            found.append(LogColumn(name, index, source, "", multiplier, stated=bool(suffix)))
    return found


def _unit_apart(name: str, given: str, head: _Header) -> tuple[str, str]:
    """Return the column and the unit of ``COLUMN:us``, which may itself hold colons."""
    source, _, suffix = given.rpartition(":")
    if given in head.names or source not in head.names:
        source, suffix = given, ""
    if source not in head.names:
        raise head.error(f"mapping of {name}: {unknown_name(source, head.names)}")
    known = MS_PER if name in TIMED else _MULTIPLIERS
    if suffix and suffix not in known:
        message = f"mapping of {name}: expected {source}:UNIT with one of {', '.join(known)}"
        raise head.error(f"{message}, got {suffix}")
    return source, suffix
