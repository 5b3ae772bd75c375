"""Tables 1 and 2 of Peng, Park and Cao, "A real-time system of crowd rendering", 2011."""

from typing import NamedTuple


class Row(NamedTuple):
    """A row of Table 1: times in milliseconds."""

    instances: int
    fps: float
    selection_ms: float
    reformation_ms: float
    animation_ms: float
    rendering_ms: float
    triangles: int

    @property
    def frame_ms(self) -> float:
        """Sum of the four stages."""
        return self.selection_ms + self.reformation_ms + self.animation_ms + self.rendering_ms


TABLE_1 = (
    Row(32, 337.0, 0.28, 0.084, 0.0004, 2.603, 40_056),
    Row(64, 292.0, 0.32, 0.11, 0.0004, 2.994, 49_236),
    Row(128, 228.0, 0.34, 0.13, 0.001, 3.915, 78_058),
    Row(256, 156.0, 0.35, 0.21, 0.002, 5.848, 139_642),
    Row(512, 111.0, 0.42, 0.32, 0.004, 8.265, 211_685),
    Row(1_024, 79.0, 0.43, 0.49, 0.006, 11.732, 329_594),
    Row(2_048, 47.0, 0.44, 0.89, 0.014, 19.933, 617_031),
    Row(4_096, 26.0, 0.48, 1.75, 0.032, 36.200, 1_182_280),
    Row(8_192, 16.0, 0.58, 3.08, 0.054, 58.786, 1_946_977),
)


class Reformation(NamedTuple):
    """A row of Table 2."""

    instances: int
    triangles: int
    reformation_ms: float


TABLE_2 = (
    Reformation(2_048, 617_031, 0.95),  # 0.89 in Table 1
    Reformation(4_096, 1_182_280, 1.75),
    Reformation(8_192, 1_946_977, 3.08),
    Reformation(16_384, 3_103_167, 5.23),
    Reformation(32_768, 6_184_824, 10.47),
)

FULL_TRIANGLES = 2_620
"""Of a character."""

COARSEST_TRIANGLES = 190
"""Fig. 3."""

SHARE_PCT = 6.65
"""Selection and reformation of the whole, Fig. 5(a)."""

SPEEDUP = (1.22, 5.33)
"""Least and greatest over pseudo-instancing."""
