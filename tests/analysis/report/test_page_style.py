"""The page's colours can be read."""

import re
from pathlib import Path

import numpy as np

from lodbench.analysis.report import page


def test_colours_can_be_read_on_their_ground() -> None:
    """Words have a contrast of 4.5, lines of 3, in light, dark and print (WCAG 2.2)."""
    css = (Path(page.__file__).parent / "templates" / "page.css").read_text()
    for theme in re.findall(r":root {(.*?)}", css, re.DOTALL):
        colors = dict(re.findall(r"--([\w]+): (#\w{6})", theme))
        for name, color in colors.items():
            for ground in ("page", "soft"):
                if name in {"ink", "dim", "bad", "link"}:
                    assert contrast(color, colors[ground]) >= 4.5, (name, ground)
            if re.fullmatch(r"c\d|heat|warn", name):
                assert contrast(color, colors["page"]) >= 3.0, name


def contrast(one: str, other: str) -> float:
    """Return the contrast ratio of two colours, by WCAG 2.2."""
    lights = sorted(luminance(color) + 0.05 for color in (one, other))
    return lights[1] / lights[0]


def luminance(color: str) -> float:
    """Return the relative luminance of a colour such as #0072b2, by WCAG 2.2."""
    parts = (int(color[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return float(np.dot(linear, (0.2126, 0.7152, 0.0722)))
