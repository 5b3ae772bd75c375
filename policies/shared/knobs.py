"""Knobs that several policies have."""

from ..knob import Knob

# Linear: what a frame costs before its first object does not shrink with the share, so that all
# shares below that draw the same.

AIM = Knob("aim", 0.1, 1.5, scale="linear")
"""Of a policy that spends a predicted time: the share of the budget that it may take.

To the end of what is allowed: where bounds are in the way, some leave a third unspent.
"""

TARGET = Knob("target", 0.1, 1.0, scale="linear")
"""Of a policy that steers by measured times: the share of the budget that it aims at."""
