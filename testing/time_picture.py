"""Frame times as an SVG picture: a bar a frame and run, and a line at the budget."""

from collections.abc import Sequence
from xml.sax.saxutils import escape

from ..base.arrays import FloatArray

_WIDTH, _HEIGHT, _LEFT, _TOP, _BOTTOM = 640, 240, 48, 28, 28
_COLOURS = ("#3b6ea5", "#c7782f", "#5f8f4e")
_OVER = "#b23a3a"


def draw_frame_times(runs: Sequence[tuple[str, FloatArray]], budget_ms: float, title: str) -> str:
    """Return the picture of one or several runs of up to some hundred frames."""
    top_ms = 1.1 * max(budget_ms, *(float(work_ms.max(initial=0.0)) for _, work_ms in runs))
    frames = max(len(work_ms) for _, work_ms in runs)
    scale = (_HEIGHT - _TOP - _BOTTOM) / top_ms
    floor = _HEIGHT - _BOTTOM
    pitch = (_WIDTH - _LEFT - 8) / max(frames, 1)
    wide = 0.8 * pitch / len(runs)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_WIDTH}" height="{_HEIGHT}">',
        f'<rect width="{_WIDTH}" height="{_HEIGHT}" fill="white"/>',
        _text(_LEFT, 16, title),
    ]
    for at, (name, work_ms) in enumerate(runs):
        for frame, ms in enumerate(work_ms.tolist()):
            colour = _OVER if ms > budget_ms and len(runs) == 1 else _COLOURS[at % len(_COLOURS)]
            x, high = _LEFT + frame * pitch + at * wide, ms * scale
            parts.append(
                f'<rect x="{x:.1f}" y="{floor - high:.1f}" width="{wide:.1f}" '
                f'height="{high:.1f}" fill="{colour}"><title>{escape(name)}, frame {frame}: '
                f"{ms:.3g} ms</title></rect>"
            )
    line = floor - budget_ms * scale
    parts += [
        f'<line x1="{_LEFT}" x2="{_WIDTH - 8}" y1="{line:.1f}" y2="{line:.1f}" stroke="black"/>',
        _text(4, line + 4, f"{budget_ms:.3g} ms"),
        _text(_LEFT, _HEIGHT - 8, f"frame 0 to {frames - 1}: {', '.join(n for n, _ in runs)}"),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _text(x: float, y: float, words: str) -> str:
    font = 'font-family="sans-serif" font-size="11"'
    return f'<text x="{x:.1f}" y="{y:.1f}" {font}>{escape(words)}</text>'
