"""The terms that GPU predictors name, each found by its name in a file of this folder."""

import importlib

from ....base.predictors import GPU_PREDICTORS, LEVEL_PREDICTORS
from .term import FrameTerm, ViewTerm


def _load(name: str) -> ViewTerm | FrameTerm:
    module = importlib.import_module(f".{name}", __package__)
    term = getattr(module, name.title().replace("_", ""))()
    assert isinstance(term, ViewTerm | FrameTerm), f"{name} is a cost term"
    return term


_TERMS = {name: _load(name) for name in GPU_PREDICTORS if name not in LEVEL_PREDICTORS}

VIEW_TERMS = {name: term for name, term in _TERMS.items() if isinstance(term, ViewTerm)}
"""Terms of each object, by predictor."""

FRAME_TERMS = {name: term for name, term in _TERMS.items() if isinstance(term, FrameTerm)}
"""Terms of the frame as a whole, by predictor."""
