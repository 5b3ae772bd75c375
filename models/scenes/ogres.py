"""LODManager's demonstrations: a field of ogres, and the same with trees.

3,000 ogres of 1,960 triangles that may fall to 10 %, and 100 trees of 97,133 triangles that may
fall to 10 % (Gumbau, Ripolles and Chover, section 5).  Both are continuous: an ordered mesh for
the ogre and the trunk, leaves that collapse in pairs and keep their area for the crown.
"""

import numpy as np

from ..continuous.foliage import Foliage, Leaves, collapse_leaves, leaf_triangles
from ..continuous.knots import KnotOptions, OrderedSurface, build_continuous
from ..layouts.placement import place
from ..layouts.scene_builder import scene_of_objects
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.shapes import lump, move_part, revolved
from ..meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface
from ..meshes.type_model import TypeModel, measure_levels
from ..scene.scene import Scene
from .scene_registry import BundledScene

_SEED = 2008
_OGRES, _TREES = 3_000, 100
_SIDE_M = 180.0
_KNOTS = 12
_LEAST = 0.1  # share of the triangles, of both types
_LEAVES = 47_742
_TRUNK_ROWS, _TRUNK_SIDES = 48, 17  # 2 · 48 · 17 triangles, and 17 of the tip
_SAMPLING = Sampling(vertices=5_000, surface=2_000)


def build_ogres() -> tuple[Scene, Geometry]:
    """Return 3,000 ogres scattered over 180 m by 180 m."""
    shape_rng, place_rng = np.random.default_rng(_SEED).spawn(2)
    return _scatter("ogres", [_ogre(shape_rng)], [_OGRES], place_rng)


def build_ogres_trees() -> tuple[Scene, Geometry]:
    """Return 3,000 ogres and 100 trees scattered over 180 m by 180 m."""
    shape_rng, place_rng = np.random.default_rng(_SEED).spawn(2)
    models = [_ogre(shape_rng), _tree(shape_rng)]
    return _scatter("ogres-trees", models, [_OGRES, _TREES], place_rng)


def _scatter(
    name: str, models: list[TypeModel], counts: list[int], rng: np.random.Generator
) -> tuple[Scene, Geometry]:
    kind = np.repeat(np.arange(len(models), dtype=np.int32), counts)
    n = len(kind)
    scale = rng.uniform(0.9, 1.1, n)
    # Crowns may reach over ogres: their trunks only keep apart.
    radius = np.array([0.6, 1.5])[kind]
    plan = place("scatter", scale * radius, rng, side_m=_SIDE_M)
    yaw = rng.uniform(-np.pi, np.pi, n)
    return scene_of_objects(name, models, kind, plan, yaw, scale)


def _ogre(rng: np.random.Generator) -> TypeModel:
    mesh = ogre_mesh(rng)
    least = round(_LEAST * len(mesh.faces))
    return build_continuous(OrderedSurface.of(mesh), KnotOptions(_KNOTS, least), _SAMPLING)


def ogre_surface() -> OrderedSurface:
    """Return the ogre of the scenes with all of its levels, not only those that are measured."""
    shape_rng, _ = np.random.default_rng(_SEED).spawn(2)
    return OrderedSurface.of(ogre_mesh(shape_rng))


def ogre_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return an ogre 2.4 m tall of 1,960 triangles: body, head, limbs and two horns."""
    body = move_part(lump(rng, 3, 0.1), (0.0, 0.0, 1.4), (0.5, 0.38, 0.6))
    head = move_part(lump(rng, 2, 0.12), (0.0, -0.1, 2.1), (0.22, 0.25, 0.28))
    limbs = [
        move_part(lump(rng, 1, 0.1), center, radii)
        for center, radii in (
            ((-0.25, 0.0, 0.45), (0.17, 0.19, 0.5)),
            ((0.25, 0.0, 0.45), (0.17, 0.19, 0.5)),
            ((-0.62, -0.1, 1.35), (0.14, 0.15, 0.5)),
            ((0.62, -0.1, 1.35), (0.14, 0.15, 0.5)),
        )
    ]
    horns = [
        move_part(revolved([(0.0, 0.06), (0.25, 0.01)], 10), (x, -0.1, 2.3), 1.0)
        for x in (-0.15, 0.15)
    ]
    return clean_surface("ogre", [body, head, *limbs, *horns]).standing(y_up=False, height_m=2.4)


def _tree(rng: np.random.Generator) -> TypeModel:
    """Return a tree 12 m tall of 97,133 triangles, trunk and leaves coarsened alike."""
    trunk = OrderedSurface.of(clean_surface("trunk", [_trunk()]))
    foliage = collapse_leaves(_crown(rng), least=round(_LEAST * _LEAVES))
    shares = np.geomspace(1.0, _LEAST, _KNOTS)
    surfaces = [_tree_surface(trunk, foliage, float(share)) for share in shares]
    return measure_levels(surfaces, _SAMPLING, continuous=True)


def _trunk() -> MeshPart:
    """Return a bent, tapering trunk that is open at its foot and closed at its tip."""
    height = np.linspace(0.0, 9.0, _TRUNK_ROWS + 1)
    radius = 0.35 * (1.0 - height / 9.5) + 0.12 * np.exp(-3.0 * height)
    tube = revolved(list(zip(height.tolist(), radius.tolist(), strict=True)), _TRUNK_SIDES)
    ring = _TRUNK_ROWS * _TRUNK_SIDES + np.arange(_TRUNK_SIDES)
    tip = np.full(_TRUNK_SIDES, len(tube.vertices))
    points = np.concatenate((tube.vertices, [[0.0, 0.0, 9.1]]))
    points[:, 0] += 0.15 * np.sin(0.7 * points[:, 2])
    faces = np.stack((ring, np.roll(ring, -1), tip), axis=1)
    return MeshPart(points, np.concatenate((tube.faces, faces)), material=0)


def _crown(rng: np.random.Generator) -> Leaves:
    """Return leaves of about 9 by 5 cm in clusters about the ends of branches."""
    clusters = 400
    direction = rng.normal(size=(clusters, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    reach = 3.2 * np.cbrt(rng.uniform(0.15, 1.0, (clusters, 1)))
    heart = direction * reach * (1.0, 1.0, 1.2) + (0.0, 0.0, 8.0)
    center = heart[rng.integers(clusters, size=_LEAVES)] + rng.normal(0.0, 0.28, (_LEAVES, 3))
    along = rng.normal(size=(_LEAVES, 3))
    across = np.cross(along, rng.normal(size=(_LEAVES, 3)))
    half = rng.uniform(0.035, 0.055, (_LEAVES, 1))
    along *= half / np.linalg.norm(along, axis=1, keepdims=True)
    across *= 0.55 * half / np.linalg.norm(across, axis=1, keepdims=True)
    return Leaves(center, along, across)


def _tree_surface(trunk: OrderedSurface, foliage: Foliage, share: float) -> SurfaceMesh:
    faces, _, _ = trunk.extract(round(share * len(trunk.full.faces)))
    rows = foliage.extract(round(share * foliage.full))
    points, leaves = leaf_triangles(foliage.leaves.at(rows))
    bark = MeshPart(trunk.full.positions, faces, material=0)
    return clean_surface("tree", [bark, MeshPart(points, leaves, material=1)])


OGRES = BundledScene("3,000 ogres of 1,960 triangles, continuous to 10 %", build_ogres)
OGRES_TREES = BundledScene(
    "the same with 100 trees of 97,133 triangles, continuous to 10 %", build_ogres_trees
)
