"""A run: one policy replayed in one place under one seed, as a small value.

Its inputs are named by content hash, so that a run can be sent anywhere, and found again among
results that are years old.
"""

import hashlib
from dataclasses import dataclass
from typing import Any, ClassVar

from ...base.content_hash import SIZE_BYTES
from ...policies.policy_spec import PolicySpec
from ...sim.replay import ReplayOptions
from .code_hash import code_hash, policy_hash
from .engine.task import Beat, Inputs
from .score import MISS, Scored, World, score


@dataclass(frozen=True, slots=True)
class Run:
    """One replay and its scores.

    Attributes
    ----------
    policy : PolicySpec
    scene, trace, hardware : str
        Content hashes of the inputs.
    options : ReplayOptions
        Its `draw` is the draw of the machine that plays the truth, None for the profile's mean.
    warmup_s : float
        Seconds at the start of the path that do not count.
    miss : float
        Share of time for which the budget may be exceeded.
    keeps_log : bool
        Whether the result has the frame log.
    keeps_levels : bool
        Whether that tells at which level each node was drawn.
    """

    policy: PolicySpec
    scene: str
    trace: str
    hardware: str
    options: ReplayOptions
    warmup_s: float
    miss: float = MISS
    keeps_log: bool = False
    keeps_levels: bool = False

    result_type: ClassVar[Any] = Scored

    @property
    def owner(self) -> str:
        """The policy's label (see `Task`)."""
        return self.policy.label

    @property
    def digest(self) -> str:
        """Content hash of the run: of its inputs, its policy, its options and the code.

        Raises TypeError as `policy_hash` does.
        """
        # One text in place of a walk over the fields: a study may have 100,000 runs.
        named = (
            code_hash(),
            policy_hash(self.policy),
            self.scene,
            self.trace,
            self.hardware,
            repr(self.options),
            repr((self.warmup_s, self.miss, self.keeps_log, self.keeps_levels)),
        )
        digest = hashlib.blake2b("\n".join(named).encode(), digest_size=SIZE_BYTES)
        return digest.hexdigest()

    def __call__(self, inputs: Inputs, beat: Beat) -> Scored:
        """Replay and score (see `Task`)."""
        world = World(
            inputs[self.scene],
            inputs[self.trace],
            inputs[self.hardware],
            self.options,
            self.warmup_s,
            self.miss,
        )
        return score(
            world,
            self.policy,
            keeps_log=self.keeps_log,
            beat=beat,
            keeps_levels=self.keeps_levels,
        )
