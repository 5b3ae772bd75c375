"""The two sets of paths of a search: those it looks at, and others of the kind."""

from dataclasses import dataclass

from ....models.scene.scene import Scene
from ....traces.cameras.camera_trace import CameraTrace
from ....traces.cameras.generators.generate import KINDS
from ....traces.cameras.vary import vary
from ..inputs import Seconds
from ..paths import MOST_PATHS, load_paths

_APART = 10_000
"""Beyond the seeds of comparisons, whose paths are then as new to what was found as any other."""


@dataclass(frozen=True, slots=True)
class Paths:
    """What parameters are searched on, and what their gain is confirmed on: two or more each."""

    training: tuple[CameraTrace, ...]
    judged: tuple[CameraTrace, ...]


def draw_paths(
    trace: str,
    scene: Scene,
    place: str = "shrink",
    *,
    paths: int,
    length_s: float | None = None,
    seconds: Seconds | None = None,
    seed: int = 0,
) -> Paths:
    """Return two sets of so many paths of a kind of movement; of a recording, its variations.

    Raises `InputError` as `load_paths` does.

    Parameters
    ----------
    trace
        As `load_paths` takes it.  Of a pattern, each file has as many variations.
    length_s, seconds
        As `load_paths` takes them.
    """

    def draw(seed: int) -> tuple[CameraTrace, ...]:
        found = load_paths(
            [trace], scene, place, paths=paths, length_s=length_s, seconds=seconds, seed=seed
        )
        if trace in KINDS:
            return found
        first = seed * MOST_PATHS + 1  # as of kinds
        return tuple(vary(path, first + number) for path in found for number in range(paths))

    first = _APART + 2 * seed
    return Paths(draw(first), draw(first + 1))
