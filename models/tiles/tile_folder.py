"""Files that a tileset may read: those in its own folder, and none beyond."""

import os
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote, urlsplit

from ...base.errors import InputError


@dataclass(frozen=True, slots=True)
class Folder:
    """A folder inside the outermost tileset's, from which URIs are resolved."""

    outermost: Path
    here: Path
    _known: dict[str, Path | None] = field(default_factory=dict[str, Path | None])

    def find(self, link: str) -> Path | None:
        """Return the file of a URI, or None if it is not on this disk.

        Raises `InputError` if the URI leads out of the outermost tileset's folder.
        """
        if link not in self._known:
            self._known[link] = self._look(link)
        return self._known[link]

    def _look(self, link: str) -> Path | None:
        try:
            parts = urlsplit(link)
            if parts.scheme in ("http", "https"):
                return None
            # By its letters first, as most contents are absent and following links is slow.
            path = Path(os.path.normpath(self.here / unquote(parts.path)))
            inside = not parts.scheme and not parts.netloc and path.is_relative_to(self.outermost)
            if inside and not path.is_file():
                return None
            if inside and (path := path.resolve()).is_relative_to(self.outermost):
                return path
        except (ValueError, OSError, RuntimeError) as error:  # no path, or a loop of links
            raise InputError(f"uri: expected a relative path, got {link[:80]!r}") from error
        raise InputError(
            f"uri: expected a path inside the tileset's folder, got {link[:80]!r}; tiles are read "
            "from that folder only"
        )

    def read(self, link: str, most: int) -> bytes:
        """Return the bytes of a URI; raises InputError if it is not there or too large."""
        path = self.find(link)
        if path is None:
            raise InputError(f"uri: expected a file of that name, got none for {link[:80]!r}")
        size = path.stat().st_size
        if size > most:
            raise InputError(f"uri: expected at most {most} bytes, got {size} in {link[:80]!r}")
        return path.read_bytes()

    def beside(self, path: Path) -> "Folder":
        """Return the folder of a file in it."""
        return Folder(self.outermost, path.parent)
