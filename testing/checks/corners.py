"""Checks that selections are valid in frames that a usual walk does not have."""

from unittest import SkipTest

import numpy as np

from .check_scenes import camera_at, lone_object
from .driver import CheckError, Player
from .walks import WALK, Factory, budget_between, difference, fitting_scenes, play

_AWAY = camera_at(-20.0, turned_deg=180.0)


def valid_selections(factory: Factory) -> None:
    """Every selection of a walk with cuts is valid, with a little budget and with plenty."""
    for scene in fitting_scenes(factory):
        for share in (0.2, 2.0):
            play(factory(), scene, budget_between(scene, share))


def empty_frames(factory: Factory) -> None:
    """Frames without candidates play, in the beginning or between others."""
    for scene in fitting_scenes(factory):
        walk = (_AWAY, WALK[0], WALK[1], _AWAY, _AWAY, WALK[2])
        play(factory(), scene, budget_between(scene, 0.4), walk)


def one_object(factory: Factory) -> None:
    """Scenes of a single object play, in view and out of it."""
    for scene in fitting_scenes(factory):
        alone = lone_object(scene)
        for share in (0.4, 2.0):
            play(factory(), alone, budget_between(alone, share), (*WALK[:3], _AWAY, WALK[0]))


def next_to_no_budget(factory: Factory) -> None:
    """Budgets of a nanosecond play; one of 0 is refused before a policy hears of it."""
    for scene in fitting_scenes(factory):
        play(factory(), scene, 1e-6)


def everything_resident(factory: Factory) -> None:
    """Where all nodes are in memory a policy decides as if nothing was streamed."""
    for scene in fitting_scenes(factory):
        budget_ms = budget_between(scene, 0.4)
        player = Player(factory(), scene, budget_ms, resident=np.ones(len(scene), dtype=np.bool_))
        for played, camera in zip(play(factory(), scene, budget_ms), WALK, strict=True):
            if (message := difference(played, player.play(camera))) is not None:
                raise CheckError(message)


def draws_what_is_resident(factory: Factory) -> None:
    """Nothing is drawn whose data are not in memory, by a policy that needs a loader."""
    if not factory().capabilities.loader:
        raise SkipTest("needs no loader")
    for scene in fitting_scenes(factory):
        if not scene.flat:
            rng = np.random.default_rng(3)
            resident = (scene.parent < 0) | (rng.random(len(scene)) < 0.6)
            player = Player(factory(), scene, budget_between(scene, 2.0), resident=resident)
            for camera in WALK:
                player.play(camera)
