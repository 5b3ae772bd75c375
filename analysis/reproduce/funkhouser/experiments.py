"""Which experiments of the paper there are."""

from ..experiment import Experiment
from .walkthrough import WALKTHROUGH

EXPERIMENTS: tuple[Experiment, ...] = (WALKTHROUGH,)
