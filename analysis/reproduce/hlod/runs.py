"""Trials that several of the thesis' experiments read: each is replayed once."""

from collections.abc import Mapping

from ..trial import Numbers, Trial, trial
from .setting import SHARED, THESIS

Runs = Mapping[str, Numbers]

_NAMES = {THESIS: "thesis", SHARED: "shared"}


def seeds(reduced: bool) -> range:
    """Return the seeds of noise."""
    return range(1) if reduced else range(5)


def frames(reduced: bool) -> int:
    """Return how many frames a run has at most until the share has settled and 400 more."""
    return 500 if reduced else 1400


def key(policy: str, path: str, seed: int) -> str:
    """Return the key of a run."""
    return f"{_NAMES[policy]}/{path}/{seed}"


def run(policy: str, path: str, seed: int, *, reduced: bool) -> Trial:
    """Return a run that experiments share."""
    arguments = {"policy": policy, "path": path, "seed": seed, "frames": frames(reduced)}
    return trial(key(policy, path, seed), "hlod.setting:measure", arguments)


def runs(policy: str, path: str, *, reduced: bool) -> list[Trial]:
    """Return the runs of all seeds."""
    return [run(policy, path, seed, reduced=reduced) for seed in seeds(reduced)]


def of_seeds(numbers: Runs, policy: str, path: str, *, reduced: bool) -> list[Numbers]:
    """Return what the runs of all seeds gave."""
    return [numbers[key(policy, path, seed)] for seed in seeds(reduced)]
