"""Which experiments of the paper there are."""

from ..experiment import Experiment
from .cows import COWS
from .tom import TOM
from .turn import TURN

EXPERIMENTS: tuple[Experiment, ...] = (TURN, TOM, COWS)
