"""Fixtures shared by all tests: the real data's folder, and builders of small things by hand."""

import importlib
import os
import subprocess
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

from lodbench.base.errors import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.machine.cost import CostModel, CpuCostModel
from lodbench.models.machine.hardware import Display, HardwareProfile, Provenance
from lodbench.models.machine.residual import Residual
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.frustum import Culler
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.motion import Centers
from lodbench.models.scene.scene import ObjectTypes, Scene
from lodbench.policies.frame_times import Completed
from lodbench.policies.view import FrameState, View
from lodbench.render.gl.context import open_target
from lodbench.traces.cameras.camera_trace import CameraTrace

# The same examples in every run of CI, so that a failure there is about the change.
settings.register_profile("ci", derandomize=True, deadline=None)
settings.register_profile("local", deadline=None)
settings.load_profile("ci" if os.environ.get("CI") else "local")

ROOT = Path(__file__).parents[1]
FULL_STUDIES = os.environ.get("LODBENCH_STUDIES") == "full"
"""Whether long studies run whole, as `make studies` has it, or in the reduced form of CI."""

UPRIGHT = (0.0, 0.0, 0.0, 1.0)  # looks along -z, x to the right and y up


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """Return the folder of real data; the test is skipped only where it is absent."""
    named = os.environ.get("LODBENCH_DATA")
    folder = Path(named) if named else ROOT.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"real data not found: no folder {folder.name}; set LODBENCH_DATA")
    return folder


@pytest.fixture(scope="session")
def tracked_files(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Return the names of files that a clone holds: all but what .gitignore names.

    Git is asked about the checkout as if it were new, so that an unpacked archive will do.
    """
    git = ["git", f"--git-dir={tmp_path_factory.mktemp('git')}"]
    subprocess.run([*git, "init", "--quiet", "--bare"], check=True)
    listing = [*git, f"--work-tree={ROOT}", "ls-files", "-z", "--others", "--exclude-standard"]
    listed = subprocess.run(listing, cwd=ROOT, capture_output=True, text=True, check=True)
    return sorted(filter(None, listed.stdout.split("\0")))


@pytest.fixture(scope="session")
def full_studies() -> bool:
    """Return whether long studies run whole or in their reduced form."""
    return FULL_STUDIES


@pytest.fixture(scope="session")
def start_cluster(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Any]:
    """Return what starts a Dask cluster of workers with a thread each, as a context manager."""
    distributed: Any = importlib.import_module("distributed")
    # Fifteen seconds after a worker was lost, Dask gives up a worker of its name that is not there:
    # also the one that is just being started again because it was lost a second time.
    dask: Any = importlib.import_module("dask")
    dask.config.set({"distributed.deploy.lost-worker-timeout": "1h"})

    def start(n_workers: int = 2, **options: Any) -> Any:
        return distributed.LocalCluster(
            processes=True,
            n_workers=n_workers,
            threads_per_worker=1,
            dashboard_address=":0",  # any free port: several clusters run at once
            local_directory=str(tmp_path_factory.mktemp("dask")),
            **options,
        )

    return start


@pytest.fixture(scope="session")
def egl() -> None:
    """Skip tests that draw where no OpenGL is to be had."""
    try:
        open_target("egl", threads=0).close()
    except InputError as error:
        pytest.skip(f"no OpenGL through EGL: {error}")


def build_levels(
    triangles: Sequence[Sequence[float]] = ((1000.0, 250.0, 50.0),),
    *,
    error_m: Sequence[Sequence[float]] | None = None,
    continuous: bool | Sequence[bool] = False,
    draw_calls: float = 1.0,
) -> LevelTable:
    """Build levels from chains of triangles; level i errs by i decimetres unless told."""
    errors = error_m or [[0.1 * i for i in range(len(chain))] for chain in triangles]
    flat = np.concatenate([np.asarray(chain, dtype=np.float64) for chain in triangles])
    counts = np.zeros((len(flat), len(LEVEL_PREDICTORS)))
    counts[:, LEVEL_PREDICTORS.index("triangles")] = flat
    counts[:, LEVEL_PREDICTORS.index("draw_calls")] = draw_calls
    return LevelTable(
        np.cumsum([0, *(len(chain) for chain in triangles)]),
        counts,
        np.concatenate([np.asarray(chain, dtype=np.float64) for chain in errors]),
        36.0 * flat,
        np.broadcast_to(np.asarray(continuous), (len(triangles),)),
    )


def build_scene(
    position_m: Any,
    *,
    kind: Any = 0,
    radius_m: Any = 1.0,
    center_m: Any = (0.0, 0.0, 0.0),
    scale: Any = 1.0,
    orientation_xyzw: Any = UPRIGHT,
    importance: Any = 1.0,
    parent: Any = -1,
    additive: Any = False,
    levels: LevelTable | None = None,
    **more: Any,
) -> Scene:
    """Build a scene of nodes at the given positions; single values stand for all nodes or types."""
    table = levels or build_levels()
    types = len(table.start) - 1
    n = len(position_m)

    def each(value: Any, *shape: int) -> Any:
        return np.broadcast_to(np.asarray(value), shape)

    names = tuple(f"type-{k}" for k in range(types))
    return Scene(
        "by-hand",
        ObjectTypes(names, each(center_m, types, 3), each(radius_m, types), table),
        each(kind, n),
        np.asarray(position_m, dtype=np.float64),
        each(orientation_xyzw, n, 4),
        each(scale, n),
        each(importance, n),
        each(parent, n),
        each(additive, n),
        **more,
    )


def build_hardware(
    linear: Mapping[str, float] | None = None,
    *,
    base_ms: float = 1.0,
    roofline: Mapping[str, float] | None = None,
    cpu: Mapping[str, float] | None = None,
    cpu_base_ms: float = 0.5,
    frames_in_flight: int = 2,
    residual: Residual | None = None,
    **display: Any,
) -> HardwareProfile:
    """Build a machine of 100 x 100 px without noise; one microsecond a triangle unless told."""
    return HardwareProfile(
        "by-hand",
        Provenance("assumed by a test", assumed=True),
        CostModel.of(base_ms, {"triangles": 1e-3} if linear is None else linear, roofline),
        CpuCostModel.of(cpu_base_ms, cpu or {}),
        residual or Residual(),
        display=replace(
            Display("immediate", latency_limit=0, width_px=100, height_px=100), **display
        ),
        frames_in_flight=frames_in_flight,
    )


def build_trace(
    position_m: Any = ((0.0, 0.0, 0.0),), *, time_s: Any = None, orientation_xyzw: Any = UPRIGHT
) -> CameraTrace:
    """Build a trace through the given positions, one second apart unless told."""
    n = len(position_m)
    return CameraTrace(
        "by-hand",
        np.arange(n, dtype=np.float64) if time_s is None else np.asarray(time_s),
        np.asarray(position_m, dtype=np.float64),
        np.broadcast_to(np.asarray(orientation_xyzw), (n, 4)),
        np.zeros(n, dtype=np.bool_),
    )


def build_view(
    scene: Scene,
    camera: Camera | None = None,
    *,
    detail: Any = np.nan,
    work_ms: Sequence[float] = (),
    **state: Any,
) -> View:
    """Build what a policy sees of a scene at rest, with past details and reported work times."""
    camera = camera or Camera((0.0, 0.0, 0.0), UPRIGHT, 100, 100, np.pi / 2)
    centers = Centers(scene.center_m, scene.motion)
    culler = Culler(centers, scene.radius_m, scene.blocks)
    ids, xyz_m = culler.cull(centers.at(0.0), camera)
    times = np.repeat(np.asarray(work_ms, dtype=np.float64)[:, None], 4, axis=1)
    last = np.broadcast_to(np.asarray(detail, dtype=np.float64), (len(scene),))
    seen = FrameState(
        scene,
        camera,
        centers.at(0.0),
        len(times),
        0,
        last,
        Completed(times, len(times)),
        culler.inside,
    )
    return View(replace(seen, **state), ids, xyz_m)


@pytest.fixture(scope="session")
def make_levels() -> Callable[..., LevelTable]:
    """Return `build_levels`."""
    return build_levels


@pytest.fixture(scope="session")
def make_scene() -> Callable[..., Scene]:
    """Return `build_scene`."""
    return build_scene


@pytest.fixture(scope="session")
def make_hardware() -> Callable[..., HardwareProfile]:
    """Return `build_hardware`."""
    return build_hardware


@pytest.fixture(scope="session")
def make_trace() -> Callable[..., CameraTrace]:
    """Return `build_trace`."""
    return build_trace


@pytest.fixture(scope="session")
def make_view() -> Callable[..., View]:
    """Return `build_view`."""
    return build_view


def _quadtree(kept: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return depth, cell and parent of the nodes above the kept cells of a 2^depth square grid."""
    depth = int(np.log2(len(kept)))
    layers = [kept]
    for _ in range(depth):
        fine = layers[-1]
        layers.append(fine[::2, ::2] | fine[1::2, ::2] | fine[::2, 1::2] | fine[1::2, 1::2])
    layers.reverse()
    cells = [np.argwhere(layer) for layer in layers]
    parents, start = [np.full(len(cells[0]), -1)], 0
    for d in range(1, depth + 1):
        node = np.full(layers[d - 1].shape, -1)
        node[layers[d - 1]] = start + np.arange(len(cells[d - 1]))
        parents.append(node[cells[d][:, 0] // 2, cells[d][:, 1] // 2])
        start += len(cells[d - 1])
    at = np.repeat(np.arange(depth + 1), [len(c) for c in cells])
    return at, np.concatenate(cells), np.concatenate(parents)


def _styria_levels(splats: float) -> LevelTable:
    """Return inner and leaf patches, nothing, and groups of 16, 32, 48 and 64 trees."""
    trees = np.array([16.0, 32.0, 48.0, 64.0])
    counts = np.zeros((11, len(LEVEL_PREDICTORS)))
    counts[:2] = [{"draw_calls": 1.0, "vertices": 33.0**2}.get(p, 0.0) for p in LEVEL_PREDICTORS]
    counts[:2, LEVEL_PREDICTORS.index("triangles")] = 2.0 * 32.0**2
    counts[3:, LEVEL_PREDICTORS.index("draw_calls")] = np.repeat(trees, 2)
    counts[3::2, LEVEL_PREDICTORS.index("splats")] = trees * splats
    counts[4::2, LEVEL_PREDICTORS.index("splats")] = trees
    return LevelTable(
        np.array([0, 1, 2, 3, 5, 7, 9, 11]),
        counts,
        np.array([0.02, 0.0, 0.0, *(0.0, 0.05) * 4]),
        30.0 * counts.sum(axis=1),
        np.arange(7) > 2,
    )


def build_styria(
    seed: int = 0,
    *,
    width_m: float = 120_000.0,
    terrain_depth: int = 5,
    forest_depth: int = 6,
    wooded: float = 0.5,
    splats: float = 512.0,
) -> Scene:
    """Build a small likeness of Zach's test: a terrain quadtree, and one over groups of trees.

    Nodes of the terrain are strips of 33² vertices.  A share `wooded` of the finest cells of the
    other tree holds a group of 16 to 64 trees, a draw call each, of 1 to `splats` splats a tree;
    nodes above them have no geometry.
    """
    rng = np.random.default_rng(seed)
    side = 2**terrain_depth
    terrain = _quadtree(np.ones((side, side), dtype=bool))
    forest = _quadtree(rng.random((2**forest_depth, 2**forest_depth)) < wooded)
    depth, cell = (np.concatenate(pair) for pair in zip(terrain[:2], forest[:2], strict=True))
    ground = len(terrain[0])
    parent = np.concatenate((terrain[2], np.where(forest[2] < 0, -1, forest[2] + ground)))
    kind = np.where(np.arange(len(depth)) < ground, depth == terrain_depth, 2)
    groups = (np.arange(len(depth)) >= ground) & (depth == forest_depth)
    kind[groups] = rng.integers(3, 7, int(groups.sum()))
    cell_m = width_m / 2.0**depth
    middle_m = (cell + 0.5) * cell_m[:, None]
    return build_scene(
        np.column_stack((middle_m, np.zeros(len(depth)))),
        kind=kind,
        scale=np.sqrt(0.5) * cell_m,
        parent=parent,
        levels=_styria_levels(splats),
    )


@pytest.fixture(scope="session")
def make_styria() -> Callable[..., Scene]:
    """Return `build_styria`."""
    return build_styria


@pytest.fixture(scope="session")
def flyover() -> Camera:
    """Return a camera at the middle of styria's southern edge, 3 km up, looking north and down."""
    tilt = np.radians(80.0)  # from straight down
    turn = (float(np.sin(tilt / 2.0)), 0.0, 0.0, float(np.cos(tilt / 2.0)))
    return Camera((60_000.0, 0.0, 3_000.0), turn, 1920, 1080, np.pi / 3.0)
