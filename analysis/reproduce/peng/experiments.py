"""Which experiments of the paper there are."""

from ..experiment import Experiment
from .fig5 import FIG5
from .n_rule import N_RULE
from .table1 import TABLE1
from .table2 import TABLE2

EXPERIMENTS: tuple[Experiment, ...] = (TABLE1, N_RULE, TABLE2, FIG5)
