"""Which experiments of the paper there are."""

from ..experiment import Experiment
from .comparison import COMPARISON
from .detail import FLY, WALK
from .estimate import ESTIMATE
from .frame_time import FRAME_TIME
from .memory import MEMORY
from .toggles import TOGGLES

EXPERIMENTS: tuple[Experiment, ...] = (
    FLY,
    WALK,
    ESTIMATE,
    FRAME_TIME,
    MEMORY,
    TOGGLES,
    COMPARISON,
)
