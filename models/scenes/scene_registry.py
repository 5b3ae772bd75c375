"""The bundled scenes by name: what each is, and what makes it."""

import re
from collections.abc import Callable
from typing import TypeAlias

from ..meshes.geometry import Geometry
from ..scene.scene import Scene

Build: TypeAlias = Callable[[], tuple[Scene, Geometry]]

ABOUT = {
    "atlas": "1,092 parts of a detector from 0.1 to 25 m, 3.7 million triangles, continuous",
    "city": "114 walls of blocks as trees of 2,298 nodes, 8.95 million triangles",
    "crowd-1024": "characters of 2,620 triangles, skinned; any number from crowd-32 to crowd-32768",
    "market": "1,500 pieces of furniture in the open, of 136 to 1,824 triangles",
    "ogres": "3,000 ogres of 1,960 triangles, continuous to 10 %",
    "ogres-trees": "the same with 100 trees of 97,133 triangles, continuous to 10 %",
    "plaza": "3,000 rocks, people, houses and trees; made in a few seconds, never cached",
    "soda-hall": "a building of six floors and 177 rooms, most of it behind walls",
    "styria": "terrain of 2,049² heights over 120 km, with 1.4 million trees in groups",
}
"""Names and what they stand for, sorted."""

_CROWD = re.compile(r"crowd-([1-9][0-9]{0,9})")


def find_builder(name: str) -> Build | None:
    """Return what makes the scene of a name, or None if there is no such name."""
    crowd = _CROWD.fullmatch(name)
    if crowd:
        count = int(crowd[1])
        return lambda: _crowd(count)
    makers: dict[str, Build] = {
        "atlas": _atlas,
        "city": _city,
        "market": _market,
        "ogres": _ogres,
        "ogres-trees": _ogres_trees,
        "plaza": _plaza,
        "soda-hall": _soda_hall,
        "styria": _styria,
    }
    return makers.get(name)


def _atlas() -> tuple[Scene, Geometry]:
    from .atlas import build_atlas

    return build_atlas()


def _city() -> tuple[Scene, Geometry]:
    from .city import build_city

    return build_city()


def _crowd(count: int) -> tuple[Scene, Geometry]:
    from .crowd import build_crowd

    return build_crowd(count)


def _market() -> tuple[Scene, Geometry]:
    from .market import build_market

    return build_market()


def _ogres() -> tuple[Scene, Geometry]:
    from .ogres import build_ogres

    return build_ogres()


def _ogres_trees() -> tuple[Scene, Geometry]:
    from .ogres import build_ogres_trees

    return build_ogres_trees()


def _plaza() -> tuple[Scene, Geometry]:
    from .plaza import build_plaza

    return build_plaza()


def _soda_hall() -> tuple[Scene, Geometry]:
    from .soda_hall import build_soda_hall

    return build_soda_hall()


def _styria() -> tuple[Scene, Geometry]:
    from .styria import build_styria

    return build_styria()
