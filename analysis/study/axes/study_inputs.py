"""Scenes, paths and profiles of a study: each loaded once, and named by its content."""

from collections.abc import Iterable
from functools import cache
from itertools import product
from typing import TYPE_CHECKING, Any, cast

from ....base.content_hash import content_hash
from ....traces.cameras.camera_trace import CameraTrace
from ....traces.cameras.read_trace import read_trace
from ....traces.cameras.shared_screen import together
from ..inputs import Seconds, adjust_machine, as_hardware, as_scene, load_trace_by
from .grid import Axis

if TYPE_CHECKING:
    from ....models.machine.hardware import HardwareProfile

Key = tuple[Any, ...]


class StudyInputs:
    """What the runs of a study are replayed in.

    Profiles are loaded at once, scenes and paths by `load`.

    Attributes
    ----------
    profiles : dict of str to HardwareProfile
        By what the axis of hardware calls them.
    machines : dict of tuple to HardwareProfile
        By hardware and what `MACHINE` names.
    loaded : dict of str to object
        What `load` has loaded, and the machines, by content hash.
    names : dict of str to str
        What the axes call each of these, by content hash.
    """

    def __init__(
        self,
        scene: Axis,
        trace: Axis,
        hardware: Axis,
        screens: Iterable[Axis],
        place: str,
        seconds: Seconds,
    ) -> None:
        self._scenes = dict(zip(scene.cells, scene.values, strict=True))
        self._traces = dict(zip(trace.cells, trace.values, strict=True))
        self._place, self._seconds = place, seconds
        machines = zip(hardware.cells, hardware.values, strict=True)
        self.profiles = {str(name): as_hardware(given) for name, given in machines}
        self.machines: dict[Key, HardwareProfile] = {
            (name, *others): adjust_machine(profile, *others)
            for name, profile in self.profiles.items()
            for others in product(*(axis.values for axis in screens))
        }
        self._hashes: dict[Key, str] = {}
        self.loaded: dict[str, Any] = {}
        self.names: dict[str, str] = {}
        self._read = cache(read_trace)  # a file once, however many scenes it is placed in

    def load(self, places: Iterable[tuple[Any, ...]]) -> None:
        """Load scenes and paths, by what their axes call them.

        Raises `InputError` as `load_scene` and `load_trace` do.
        """
        for scene, trace in places:
            if (scene,) not in self._hashes:
                self._add((scene,), scene, as_scene(self._scenes[scene]))
            if (scene, trace) not in self._hashes:
                self._add((scene, trace), trace, self._placed(scene, trace))
        for key, machine in self.machines.items():
            self._add(("machine", *key), key[0], machine)

    def hashes(self, scene: Any, trace: Any, machine: Key) -> tuple[str, str, str]:
        """Return the content hashes of what a run is replayed in, once it is loaded."""
        known = self._hashes
        return known[(scene,)], known[scene, trace], known[("machine", *machine)]

    def _placed(self, scene: Any, trace: Any) -> CameraTrace:
        inside, given = self.loaded[self._hashes[(scene,)]], self._traces[trace]
        players = cast("tuple[Any, ...]", given) if isinstance(given, tuple) else (given,)
        paths = [load_trace_by(self._read, path, inside, self._place) for path in players]
        return together([path.stretch(*self._seconds) for path in paths])

    def _add(self, key: Key, name: str, thing: Any) -> None:
        if key not in self._hashes:
            self._hashes[key] = digest = content_hash(thing)
            self.loaded[digest], self.names[digest] = thing, name
