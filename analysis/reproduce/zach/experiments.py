"""Which experiments of the paper there are."""

from ..experiment import Experiment
from .fig2 import FIG2, FIG4
from .fig3 import FIG3
from .scale import SCALE

EXPERIMENTS: tuple[Experiment, ...] = (FIG2, FIG3, FIG4, SCALE)
