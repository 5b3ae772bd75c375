"""A folder of results that is written while a study runs, and goes on where it was stopped."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

import pyarrow as pa

from ....base.errors import InputError
from ..engine.task import Failure, Outcome
from ..score import Scored
from .commit import GroupCommit
from .frame_logs import read_log, sweep_logs, write_log
from .manifest import PARTS, Manifest, Part, read_manifest, write_manifest
from .parts import EARLY, FINAL, find_mergeable, read_part, write_part
from .record import Entry, decode, encode
from .recovery import next_number, recover, sweep_parts
from .run_list import RunList

ROWS = 1024
"""Of a part of a finished study; the last has what is left."""


class ResultStore:
    """What became of the runs of one study, in a folder.

    An added result is on the disk half a second or 64 results later; what ends the process before
    loses it and nothing else.  The caller holds the folder (`locked`), so that nobody else writes::

        with ResultStore.open(folder, runs) as store:
            missing = store.missing
            for outcome in engine.run([runs.runs[at] for at in missing]):
                store.add(missing[outcome.index], outcome)
            store.finish()

    Leaving the block writes what was added, whatever the reason.
    """

    def __init__(
        self, folder: Path, runs: RunList, manifest: Manifest, failed: dict[int, bool]
    ) -> None:
        self._folder, self._runs, self._manifest = folder, runs, manifest
        self._failed = failed
        self._earlier = len(failed)
        self._number = next_number(manifest.parts)
        self._commit = GroupCommit(self._write)

    @classmethod
    def open(cls, folder: Path, runs: RunList, *, replaces: bool = False) -> Self:
        """Make a folder of results, or go on with what it holds (see `recover`).

        Parameters
        ----------
        replaces
            Whether results of another study in the folder are removed; else they are refused.

        Raises `InputError` if they are refused, or the folder cannot be written.
        """
        found = recover(folder, runs, replaces=replaces)
        at = {digest: at for at, digest in enumerate(runs.digests)}
        # A study that asks for runs in rounds has rows of other rounds here.
        known = {digest: value for digest, value in found.failed.items() if digest in at}
        failed = {at[digest]: value for digest, value in known.items()}
        return cls(folder, runs, found.manifest, failed)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Put all that was added on the disk; raises `InputError` if it cannot be."""
        self._commit.close()

    @property
    def missing(self) -> list[int]:
        """Positions of the runs that are yet to be carried out, in order."""
        return [at for at in self._runs.wanted(self._failed) if at not in self._failed]

    @property
    def finished(self) -> frozenset[str]:
        """Digests of the runs that have a result, which may not be on the disk yet."""
        return frozenset(self._runs.digests[at] for at in self._failed)

    @property
    def durable(self) -> int:
        """The number of results on the disk."""
        return self._earlier + self._commit.done

    @property
    def rows(self) -> int:
        """The number of rows on the disk, those of a study's other rounds too."""
        return sum(part.rows for part in self._manifest.parts)

    def add(self, at: int, outcome: Outcome) -> None:
        """Keep what became of the run at a position of the study, and its frame log.

        Raises `InputError` if what was added before cannot be written.
        """
        result: Scored | Failure = outcome.failure or outcome.result
        self._failed[at] = isinstance(result, Failure)
        self._commit.add(Entry(at, result))

    def flush(self) -> None:
        """Return when all that was added is on the disk; raises `InputError` if it cannot be."""
        self._commit.flush()

    def results(self) -> Iterator[tuple[int, Scored | Failure]]:
        """Yield what is on the disk, by position: as it was added, with its frame log."""
        at = {digest: at for at, digest in enumerate(self._runs.digests)}
        for part in self._manifest.parts:
            for digest, result in decode(read_part(self._folder, part)):
                if digest not in at:
                    continue
                run = self._runs.runs[at[digest]]
                if isinstance(result, Scored) and run.keeps_log:
                    yield at[digest], replace(result, log=read_log(self._folder, digest))
                else:
                    yield at[digest], result

    def finish(self) -> None:
        """Rewrite the results in the order of the study, by `ROWS` a file.

        So a study that was stopped and went on ends with the bytes of one that was not.  Results
        behind the first failure of their owner are left out if the study says so (`RunList.stop`).

        Raises `InputError` if they cannot be written, and ValueError if any is missing.
        """
        self.flush()
        if self._manifest.complete:
            return
        if self.missing:
            raise ValueError(f"{len(self.missing)} runs of the study are not carried out yet")
        rows = self._in_order()
        parts = [
            write_part(self._folder, FINAL, number, rows.slice(start, ROWS))
            for number, start in enumerate(range(0, len(rows), ROWS))
        ]
        self._list(parts, complete=True)
        sweep_parts(self._folder, parts)
        wanted = self._runs.wanted(self._failed)
        sweep_logs(self._folder, {self._runs.digests[at] for at in wanted})

    def _in_order(self) -> pa.Table:
        """Return all rows that count, in the order of the study."""
        tables = [read_part(self._folder, part) for part in self._manifest.parts]
        rows = pa.concat_tables(tables) if tables else encode(self._runs, [])
        row_of = {digest: row for row, digest in enumerate(rows.column("digest").to_pylist())}
        wanted = self._runs.wanted(self._failed)
        return rows.take(pa.array([row_of[self._runs.digests[at]] for at in wanted], pa.int64()))

    def _write(self, entries: Sequence[Entry]) -> None:
        """Make results durable; in the thread of the group commit."""
        part = self._write_early(encode(self._runs, [self._keep_log(item) for item in entries]))
        self._list([*self._manifest.parts, part])
        while merged := find_mergeable(self._manifest.parts):
            rows = pa.concat_tables([read_part(self._folder, part) for part in merged])
            part = self._write_early(rows)
            self._list([*(item for item in self._manifest.parts if item not in merged), part])
            for item in merged:
                (self._folder / PARTS / item.file).unlink()

    def _keep_log(self, entry: Entry) -> Entry:
        """Write the frame log that a result has, before the row that names it."""
        result = entry.result
        if isinstance(result, Failure) or result.log is None:
            return entry
        log_hash = write_log(self._folder, self._runs.digests[entry.at], result.log)
        return Entry(entry.at, replace(result, log=None), log_hash)

    def _write_early(self, rows: pa.Table) -> Part:
        part = write_part(self._folder, EARLY, self._number, rows)
        self._number += 1
        return part

    def _list(self, parts: Sequence[Part], *, complete: bool = False) -> None:
        manifest = replace(self._manifest, parts=tuple(parts), complete=complete)
        write_manifest(self._folder, manifest)
        self._manifest = manifest


def read_results(folder: Path) -> pa.Table:
    """Return the rows of a folder of results, finished or not (see `record.COLUMNS`).

    Raises `InputError` if it holds none, or a part is damaged.
    """
    manifest = read_manifest(folder)
    if manifest is None or not manifest.parts:
        advice = "name a folder that `lodbench sweep` wrote"
        raise InputError(f"expected results, got a folder without any; {advice}", path=folder)
    return pa.concat_tables([read_part(folder, part) for part in manifest.parts])
