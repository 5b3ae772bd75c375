"""Knobs that several policies have."""

from ..knob import Knob

AIM = Knob("aim", 0.05, 1.2)
"""Of a policy that spends a predicted time: the share of the budget that it may take."""

TARGET = Knob("target", 0.05, 1.0)
"""Of a policy that steers by measured times: the share of the budget that it aims at."""
