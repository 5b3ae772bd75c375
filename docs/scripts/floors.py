"""Draw the house: rooms by floor, computed from the imports that the files really make.

``make docs`` runs it; a test compares the picture with the files.
"""

import ast
from collections.abc import Mapping
from html import escape
from pathlib import Path

Imports = Mapping[str, frozenset[str]]
"""By room, the other rooms that its files import."""

_WIDTH, _HEIGHT, _GAP, _LEFT = 960, 76, 8, 12
_STYLE = (
    "rect{fill:#f5f7fa;stroke:#7a8794}text{font:13px sans-serif;fill:#1f2933}"
    ".room{font-weight:bold;font-size:16px}.inner{font-size:12px}.below{fill:#52606d}"
)


def room_imports(root: Path) -> Imports:
    """Return the rooms of a checkout, folders of the package at its root, and what each imports."""
    rooms = sorted(path.parent.name for path in root.glob("*/__init__.py"))
    rooms.remove("lodbench")  # the door: it only passes on names
    return {room: frozenset(_imported(root / room, rooms)) - {room} for room in rooms}


def _imported(room: Path, rooms: list[str]) -> set[str]:
    names: set[str] = set()
    for path in room.rglob("*.py"):
        # So many dots lead from this file to the root, where the rooms stand side by side.
        dots = len(path.relative_to(room.parent).parts)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level == dots:
                whole = [alias.name for alias in node.names]
                names.update([node.module.split(".")[0]] if node.module else whole)
    return names.intersection(rooms)


def floors(imports: Imports) -> list[list[str]]:
    """Return the rooms from the ground up, each one floor above the highest that it imports.

    Raises `ValueError` if rooms import each other in a circle.
    """
    placed: dict[str, int] = {}
    while len(placed) < len(imports):
        ready = [room for room in imports if room not in placed and imports[room] <= placed.keys()]
        if not ready:
            raise ValueError(f"rooms import each other: {sorted(imports.keys() - placed.keys())}")
        placed |= {room: 1 + max((placed[r] for r in imports[room]), default=-1) for room in ready}
    return [[r for r in imports if placed[r] == level] for level in range(1 + max(placed.values()))]


def draw_house(root: Path) -> str:
    """Return the picture as SVG, the highest floor on top."""
    imports = room_imports(root)
    levels = floors(imports)[::-1]
    height = len(levels) * (_HEIGHT + _GAP) + _GAP
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" role="img">',
        "<title>Rooms of lodbench by floor; a room imports only from floors below</title>",
        f"<style>{_STYLE}</style>",
    ]
    for level, rooms in enumerate(levels):
        width = (_WIDTH - _GAP * (len(rooms) + 1)) // len(rooms)
        for place, room in enumerate(rooms):
            x, y = _GAP + place * (width + _GAP), _GAP + level * (_HEIGHT + _GAP)
            lines.append(f'<rect x="{x}" y="{y}" width="{width}" height="{_HEIGHT}" rx="4"/>')
            below = ", ".join(sorted(imports[room])) or "nothing of the package"
            texts = (("room", f"{room}/"), ("inner", _inside(root / room)))
            shown = (*texts, ("below", f"imports {below}"))
            for row, (kind, text) in enumerate(shown):
                at = f'x="{x + _LEFT}" y="{y + 24 + 20 * row}"'
                lines.append(f'<text class="{kind}" {at}>{escape(text)}</text>')
    return "\n".join([*lines, "</svg>", ""])


def _inside(room: Path) -> str:
    inner = sorted(path.parent.name for path in room.glob("*/__init__.py"))
    return ", ".join(inner) or "files only"


if __name__ == "__main__":
    checkout = Path(__file__).parents[2]
    picture = checkout / "docs" / "images" / "floors.svg"
    picture.write_text(draw_house(checkout), encoding="utf-8")
