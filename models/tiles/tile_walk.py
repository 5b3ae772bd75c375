"""All tiles of a tileset in one table: explicit, implicit and of external tilesets."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError, about_file
from ...base.files.strict_json import decode_json
from .bounding_volumes import read_volume
from .implicit_tiling import expand, fill_template, subdivide
from .tile_folder import Folder
from .tile_schema import Tile, Tileset

MAX_TILES = 100_000
_MAX_JSON_BYTES = 32 << 20
_MAX_SUBTREE_BYTES = 16 << 20
_MAX_TILESETS = 5_000


class TileRow(NamedTuple):
    """A tile as a scene needs it.

    Attributes
    ----------
    parent : row of the parent or -1
    error : geometricError, None where it is missing
    additive : whether the tile stays drawn beside its children
    volume : bounding volume as `read_volume` gives it
    matrix : (4, 4) from the tile's frame to that of the tileset
    files : files of its contents, None for one that is not on the disk
    """

    parent: int
    error: float | None
    additive: bool
    volume: tuple[int, tuple[float, ...]]
    matrix: FloatArray
    files: list[Path | None]


@dataclass(slots=True)
class TileTable:
    """N tiles, parents first, in a list that grows during the walk.

    Attributes
    ----------
    rows : the tiles
    request_volumes : tiles with a viewerRequestVolume
    tilesets : tileset files, each as often as it is used
    """

    rows: list[TileRow] = field(default_factory=list[TileRow])
    request_volumes: int = 0
    tilesets: int = 0

    def __len__(self) -> int:
        """Return the number of tiles."""
        return len(self.rows)

    def add(self, row: TileRow) -> None:
        """Add a tile."""
        if len(self) >= MAX_TILES:
            raise InputError(f"tileset: expected at most {MAX_TILES} tiles, got more")
        if row.error is not None and not 0.0 <= row.error < np.inf:
            raise InputError(f"geometricError: expected metres >= 0, got {row.error}")
        self.rows.append(row)


@dataclass(frozen=True, slots=True)
class _Step:
    """A tile that is still to be added, and what it inherits."""

    tile: Tile
    parent: int
    matrix: FloatArray
    additive: bool
    folder: Folder
    above: tuple[Path, ...]  # tilesets that this one is inside of


def walk_tileset(path: Path) -> TileTable:
    """Read a tileset and all tilesets that it holds.

    Raises `InputError` if a file is missing, damaged or too large, a URI leads out of the tileset's
    folder, a tileset holds itself, or there are more tiles than `MAX_TILES`.
    """
    walk = _Walk(TileTable(), {})
    here = path.resolve()
    folder = Folder(here.parent, here.parent)
    stack = [_Step(walk.root(here, path), -1, np.eye(4), False, folder, (here,))]
    while stack:
        step = stack.pop()
        with about_file(path):
            stack.extend(reversed(list(walk.visit(step))))
    return walk.table


@dataclass(slots=True)
class _Walk:
    table: TileTable
    roots: dict[Path, Tile]
    json_bytes: int = 0

    def root(self, path: Path, shown: Path | None = None) -> Tile:
        """Return the root of a tileset file, read once however often it is used."""
        self.table.tilesets += 1
        if self.table.tilesets > _MAX_TILESETS:
            raise InputError(f"expected at most {_MAX_TILESETS} tilesets, got more")
        if path not in self.roots:
            self.roots[path] = self._read(path, shown or path)
        return self.roots[path]

    def _read(self, path: Path, shown: Path) -> Tile:
        if not path.is_file():
            raise InputError("expected a tileset, got no such file", path=shown)
        self.json_bytes += path.stat().st_size
        if self.json_bytes > _MAX_JSON_BYTES:
            raise InputError(
                f"expected at most {_MAX_JSON_BYTES} bytes of tilesets, got {self.json_bytes}",
                path=shown,
            )
        what, advice = "a 3D Tiles tileset", "export the file again"
        root = decode_json(path.read_bytes(), Tileset, what, advice, path=shown, first_line=1).root
        if _weigh(root) > MAX_TILES:
            message = f"expected at most {MAX_TILES} tiles and contents, got more"
            raise InputError(message, path=shown)
        return root

    def visit(self, step: _Step) -> Iterator[_Step]:
        """Add a tile, and yield what stands below it."""
        table, tile, matrix = self.table, step.tile, step.matrix
        if tile.transform is not None:
            own = np.array(tile.transform).reshape(4, 4).T
            if not np.isfinite(own).all() or not np.array_equal(own[3], (0.0, 0.0, 0.0, 1.0)):
                raise InputError("transform: expected a finite affine matrix, got another")
            matrix = matrix @ own
        table.request_volumes += tile.viewer_request_volume is not None
        additive = _refine(tile.refine, step.additive)
        volume = read_volume(tile.bounding_volume)
        if tile.implicit is not None:
            _add_implicit(table, step, TileRow(step.parent, None, additive, volume, matrix, []))
            return
        linked = [(link, step.folder.find(link)) for link in tile.links]
        files = [path for link, path in linked if not _is_tileset(link)]
        row, error = len(table), tile.geometric_error
        table.add(TileRow(step.parent, error, additive, volume, matrix, files))
        for link, path in linked:
            if _is_tileset(link) and path is not None:
                if path in step.above:
                    raise InputError(
                        f"uri: expected no cycle, got tileset {link[:80]!r} inside itself"
                    )
                below = (*step.above, path)
                inner = step.folder.beside(path)
                yield _Step(self.root(path), row, matrix, False, inner, below)
            elif _is_tileset(link):
                files.append(None)
        for child in tile.children:
            yield _Step(child, row, matrix, additive, step.folder, step.above)


def _weigh(root: Tile) -> int:
    """Return the number of tiles of a document, or of its contents if they are more."""
    tiles = contents = 0
    stack = [root]
    while stack:
        tile = stack.pop()
        tiles += 1
        contents += len(tile.contents)
        stack.extend(tile.children)
    return max(tiles, contents)


def _is_tileset(link: str) -> bool:
    return link.split("?", maxsplit=1)[0].lower().endswith(".json")


def _refine(text: str | None, inherited: bool) -> bool:
    if text is None:
        return inherited
    if text.upper() not in ("ADD", "REPLACE"):
        raise InputError(f"refine: expected ADD or REPLACE, got {text[:40]!r}")
    return text.upper() == "ADD"


def _add_implicit(table: TileTable, step: _Step, root: TileRow) -> None:
    """Add the tiles of an implicit tree; errors halve from level to level."""
    tile, tiling = step.tile, step.tile.implicit
    assert tiling is not None
    kind, numbers = root.volume
    most = MAX_TILES - len(table)
    tiles = expand(tiling, lambda link: step.folder.read(link, _MAX_SUBTREE_BYTES), most)
    flat = tiling.subdivision_scheme == "QUADTREE"
    volumes = subdivide(kind, np.array(numbers), tiles, flat=flat).tolist()
    first = len(table)
    parents: list[int] = tiles.parent.tolist()
    for i, level in enumerate(tiles.level.tolist()):
        error = None if tile.geometric_error is None else tile.geometric_error / 2.0**level
        parent = step.parent if parents[i] < 0 else first + parents[i]
        links = tile.links if tiles.content[i] else ()
        files = [step.folder.find(fill_template(link, level, tiles.cell[i])) for link in links]
        volume = (kind, tuple(volumes[i]))
        table.add(root._replace(parent=parent, error=error, volume=volume, files=files))
