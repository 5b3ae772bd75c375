"""Which experiments of the paper there are."""

from ..experiment import Experiment
from .active_list import ACTIVE_LIST
from .fig5 import FIG5
from .fig6 import FIG6
from .slots import SLOTS_EXPERIMENT

EXPERIMENTS: tuple[Experiment, ...] = (FIG6, FIG5, SLOTS_EXPERIMENT, ACTIVE_LIST)
