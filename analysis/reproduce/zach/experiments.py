"""Which experiments of the paper there are."""

from ..experiment import Experiment

EXPERIMENTS: tuple[Experiment, ...] = ()
