"""How well a fit could tell the terms of a cost model apart: for people, no simulation reads it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ...base.errors import InputError


@dataclass(frozen=True, slots=True)
class Identification:
    """What a fit says of its design.

    Attributes
    ----------
    condition : float
        Condition number of the design, each column scaled to unit length: 1 where terms are
        orthogonal, above some 30 where two of them can hardly be told apart (Belsley, Kuh and
        Welsch, Regression Diagnostics, 1980).
    variance_share : mapping of str to float
        Share of the variance of fitted times that is each term's, which sum to 1; negative where
        a term goes against the others.
    """

    condition: float
    variance_share: Mapping[str, float] = field(default_factory=dict[str, float])

    def __post_init__(self) -> None:
        if not self.condition >= 1.0:  # infinite where a term is a sum of others
            raise InputError(f"identification: expected condition >= 1, got {self.condition}")
        for name, share in self.variance_share.items():
            if not np.isfinite(share):
                raise InputError(f"identification {name}: expected a finite share, got {share}")
