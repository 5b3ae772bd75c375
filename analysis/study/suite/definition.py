"""The suites: which policies run where, fixed, so that results of one version can be compared.

Whoever changes a suite gives it the next version.  Where a scene can be drawn in full, that takes
five to ten times the budget, so that who keeps it has to choose.
"""

from dataclasses import dataclass

from ....base.content_hash import content_hash
from ....base.errors import InputError
from ....base.nearest_names import unknown_name


@dataclass(frozen=True, slots=True)
class Cell:
    """One comparison of a suite.

    Attributes
    ----------
    scene, hardware : str
        Bundled ones.
    trace : str
        A kind of movement.
    budget_ms : float
    """

    scene: str
    trace: str
    hardware: str
    budget_ms: float

    @property
    def name(self) -> str:
        """What the cell's folder is called."""
        return f"{self.scene}-{self.trace}-{self.hardware}-{self.budget_ms:g}ms"


@dataclass(frozen=True, slots=True, kw_only=True)
class Suite:
    """A study of many comparisons.

    Attributes
    ----------
    name : str
    version : int
    policies : tuple of str
        What anybody's own policy is compared with.
    cells : tuple of Cell
    paths : int
        Of the kind, in every cell.
    length_s : float
        Of each path.
    seed, seeds : int
        First seed of paths and noise, and replays of each path.
    warmup_s, miss, margin, visible_px : float
        As a comparison has them.
    """

    name: str
    version: int
    policies: tuple[str, ...]
    cells: tuple[Cell, ...]
    paths: int = 4
    length_s: float = 6.0
    seed: int = 0
    seeds: int = 2
    warmup_s: float = 1.0
    miss: float = 0.01
    margin: float = 0.1
    visible_px: float = 1.0

    @property
    def digest(self) -> str:
        """Hash of the definition: equal for suites that ask the same."""
        return content_hash(self)


QUICK = Suite(
    name="quick",
    version=1,
    policies=(
        "full",
        "static-screen",
        "feedback",
        "hoppe",
        "gobbetti",
        "hlod-hysteresis",
        "maciel",
    ),
    cells=(
        Cell("district", "trial", "desktop-assumed", 16.0),
        Cell("district", "walk", "llvmpipe", 100.0),
        Cell("city", "trial", "desktop-assumed", 8.0),
    ),
    seeds=1,
)
"""About a minute on two cores: does it run, and is it near the others?"""

STANDARD = Suite(
    name="standard",
    version=1,
    policies=(
        "full",
        "static-distance",
        "static-screen",
        "screen-space-error",
        "pixel-error",
        "feedback",
        "pid",
        "hoppe",
        "unity-adaptive",
        "unreal-dynamic",
        "lodmanager",
        "funkhouser",
        "gobbetti",
        "wimmer",
        "peng",
        "zach",
        "hlod-hysteresis",
        "mason-blake",
        "maciel",
        "erikson",
        "cluster-cut",
    ),
    cells=(
        Cell("district", "trial", "desktop-assumed", 16.0),
        Cell("district", "walk", "desktop-assumed", 8.0),
        Cell("district", "fly-over", "desktop-assumed", 6.0),
        Cell("district", "walk", "llvmpipe", 100.0),
        Cell("plaza", "trial", "desktop-assumed", 8.0),
        Cell("plaza", "trial", "llvmpipe", 100.0),
        Cell("city", "trial", "desktop-assumed", 8.0),
        Cell("city", "drive", "desktop-assumed", 8.0),
    ),
)
"""About ten minutes on two cores."""

SUITES = {suite.name: suite for suite in (STANDARD, QUICK)}


def find_suite(name: str) -> Suite:
    """Return the suite of a name; raises `InputError` if there is none, with the nearest."""
    if name not in SUITES:
        raise InputError(f"suite: {unknown_name(name, list(SUITES))}")
    return SUITES[name]
