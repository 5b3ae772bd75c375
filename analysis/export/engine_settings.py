"""What a policy is in an engine: names and values of the engine's own settings."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from ...base.errors import InputError
from ...models.scene.scene import Scene

Value = float | bool


@dataclass(frozen=True, slots=True)
class TypeSettings:
    """Settings of one type of object.

    Attributes
    ----------
    radius_m : float
        Of the bounding sphere of an object at scale 1.
    settings : dict of str to float
        Of the object as a whole, by the engine's names.
    levels : tuple of dict of str to float
        Of each level, the finest first.
    """

    name: str
    radius_m: float
    settings: dict[str, float]
    levels: tuple[dict[str, float], ...]


@dataclass(frozen=True, slots=True)
class EngineSettings:
    """A policy as settings of an engine.

    Attributes
    ----------
    scene : str or None
        None where the settings hold for any scene.
    fovy_deg : float or None
        Vertical field of view for which the settings hold; None where they hold for any.
    project : dict of str to float or bool
        Settings of the whole project, camera or tileset, by the engine's names.
    types : tuple of TypeSettings
        In the order of the scene; empty where nothing is set on objects.
    differs : tuple of str
        What the engine does otherwise than the policy did in the simulation.
    """

    engine: str
    policy: str
    scene: str | None
    fovy_deg: float | None
    project: dict[str, Value]
    types: tuple[TypeSettings, ...]
    differs: tuple[str, ...]
    schema: Literal["lodbench.engine-settings/1"] = "lodbench.engine-settings/1"


@dataclass(frozen=True, slots=True)
class Asked:
    """A policy to be set in an engine, and where.

    Attributes
    ----------
    label : str
        What the user calls the policy.
    policy : object
        An instance, whose attributes are its parameters.
    scene : Scene or None
    fovy_deg : float
    """

    label: str
    policy: Any
    scene: Scene | None
    fovy_deg: float

    def flat_scene(self) -> Scene:
        """Return the scene, whose types have levels of their own.

        Raises `InputError` if there is none, or it is a tree.
        """
        if self.scene is None:
            raise InputError(
                f"{self.label}: expected a scene, whose levels are set one by one, got none; "
                "name one with --scene"
            )
        if not self.scene.flat:
            raise InputError(
                f"{self.label}: expected a scene of objects with levels, got {self.scene.name}, a "
                "tree; name a flat one with --scene"
            )
        return self.scene

    def about_knots(self) -> tuple[str, ...]:
        """Return what is to be said of continuous types, if the scene has any."""
        if not self.flat_scene().types.levels.continuous.any():
            return ()
        return ("continuous types: a level is a mesh of one knot's resolution",)


@dataclass(frozen=True, slots=True)
class Engine:
    """An engine: the registered policies whose thresholds it has, and how they are set.

    `set` returns the settings, or raises `InputError` where it has no counterpart.
    """

    policies: tuple[str, ...]
    set: Callable[[Asked], EngineSettings]
