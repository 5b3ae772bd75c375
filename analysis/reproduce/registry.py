"""The papers, and where their experiments are."""

from importlib import import_module

from ...base.errors import InputError
from ...base.nearest_names import unknown_name
from .experiment import Experiment

PAPERS = {
    "lodmanager": "gumbau",
    "zach": "zach",
    "peng": "peng",
    "hlod": "hlod",
    "gobbetti": "gobbetti",
    "funkhouser": "funkhouser",
}
"""Folder of each paper's experiments, by the name that the command takes."""

ALL = "all"


def find_experiments(paper: str) -> tuple[Experiment, ...]:
    """Return the experiments of a paper, of all papers, or one by its id.

    Raises `InputError` if there is no such paper or experiment, with the nearest name.
    """
    if paper == ALL:
        return tuple(one for name in PAPERS for one in _load(name))
    if paper in PAPERS:
        return _load(paper)
    known = {one.id: one for name in PAPERS for one in _load(name)}
    if paper not in known:
        raise InputError(f"reproduce: {unknown_name(paper, [*PAPERS, ALL, *known])}")
    return (known[paper],)


def _load(paper: str) -> tuple[Experiment, ...]:
    module = import_module(f".{PAPERS[paper]}.experiments", __package__)
    return module.EXPERIMENTS
