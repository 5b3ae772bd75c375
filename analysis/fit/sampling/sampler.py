"""Sampling by emcee, long enough: chain length follows the integrated autocorrelation time.

Foreman-Mackey et al., "emcee: the MCMC hammer", PASP 125, 2013; Goodman and Weare, CAMCoS 5, 2010.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import emcee
import numpy as np

from ....base.arrays import FloatArray
from .chain_file import load_chain, save_chain
from .optimum import walkers_around
from .posterior import LogPosterior

LONG_ENOUGH = 50.0  # autocorrelation times; below, their own estimate is not to be trusted

_CHUNK = 250  # steps between looks at the chain
_BURN_IN = 0.1  # share of the chain that is forgotten; walkers start spread like the posterior

Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class SamplerOptions:
    """How to sample.

    Attributes
    ----------
    walkers : even, at least twice the number of parameters; raised to that where it is less
    max_steps : steps after which sampling stops, converged or not
    seed : of the start and of the proposals
    """

    walkers: int = 32
    max_steps: int = 20_000
    seed: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """What emcee left behind, burn-in removed.

    Attributes
    ----------
    names : names of D parameters
    samples : (steps, walkers, D) float64
    acceptance : share of proposals accepted
    tau : (D,) float64, integrated autocorrelation times in steps
    """

    names: tuple[str, ...]
    samples: FloatArray
    acceptance: float
    tau: FloatArray

    @property
    def flat(self) -> FloatArray:
        """Samples of all walkers, step by step, (steps · walkers, D)."""
        return self.samples.reshape(-1, len(self.names))

    @property
    def lengths(self) -> float:
        """Length of the chain in its longest autocorrelation time."""
        return len(self.samples) / float(self.tau.max())

    def thinned(self, count: int) -> FloatArray:
        """Return `count` samples, evenly spaced along the chain, (count, D)."""
        flat = self.flat
        return flat[np.linspace(0, len(flat) - 1, min(count, len(flat))).astype(np.int64)]


def sample(
    posterior: LogPosterior,
    center: FloatArray,
    options: SamplerOptions,
    *,
    resume: tuple[Path, str] | None = None,
    progress: Progress | None = None,
) -> Chain:
    """Sample a posterior from around its optimum until the chain is long enough.

    Raises `InputError` if the file to resume from is of something else.

    Parameters
    ----------
    resume
        File to go on from and to keep up to date, and what the chain is of (`chain_file`).
        An interrupted and resumed chain is the chain without interruption, bit for bit.
    progress
        Is told the steps done and the steps at most.
    """
    width = len(center)
    walkers = max(options.walkers + options.walkers % 2, 2 * width + 2)
    seeds = np.random.SeedSequence(options.seed).spawn(2)
    backend: Any = emcee.backends.Backend() if resume is None else load_chain(*resume)
    started = backend.initialized
    sampler: Any = emcee.EnsembleSampler(
        walkers, width, posterior, moves=_moves(), vectorize=True, backend=backend
    )
    if started:
        state: Any = backend.get_last_sample()
    else:
        points = walkers_around(posterior, center, walkers, np.random.default_rng(seeds[0]))
        random: Any = np.random.RandomState(np.random.MT19937(seeds[1]))
        state = emcee.State(points, random_state=random.get_state())
    steps, wanted = int(backend.iteration), _wanted(backend)
    while steps < min(wanted, options.max_steps):
        chunk = min(_CHUNK, options.max_steps - steps)
        state = sampler.run_mcmc(state, chunk, skip_initial_state_check=steps > 0)
        steps = int(backend.iteration)
        if resume is not None:
            save_chain(backend, *resume)
        if steps >= wanted:
            wanted = _wanted(backend)
        if progress is not None:
            progress(steps, min(wanted, options.max_steps))
    whole: Any = backend.get_chain(discard=int(_BURN_IN * steps))
    chain = np.asarray(whole, dtype=np.float64)
    accepted: Any = backend.accepted
    acceptance = float(np.asarray(accepted, dtype=np.float64).mean()) / steps
    return Chain(posterior.likelihood.names, chain, acceptance, _tau(chain))


def _moves() -> list[tuple[Any, float]]:
    """Return differential evolution, and every fifth step a stretch.

    ter Braak, Statistics and Computing 16, 2006.  On our logs autocorrelation times are half those
    of the stretch move alone, which brings stray walkers back.
    """
    return [(emcee.moves.DEMove(), 0.8), (emcee.moves.StretchMove(), 0.2)]


def _wanted(backend: Any) -> int:
    """Return how many steps are enough as far as the chain tells, in whole chunks.

    The looks at the chain are those of a run without interruption, so that resuming changes
    nothing.
    """
    wanted = 2 * _CHUNK
    while backend.iteration >= wanted:
        whole: Any = backend.get_chain()
        chain = np.asarray(whole[int(_BURN_IN * wanted) : wanted], dtype=np.float64)
        needed = LONG_ENOUGH * float(_tau(chain).max()) / (1.0 - _BURN_IN)
        if wanted >= needed:
            break
        wanted = _CHUNK * int(np.ceil(1.02 * needed / _CHUNK))
    return wanted


def _tau(chain: FloatArray) -> FloatArray:
    """Return integrated autocorrelation times in steps, (D,).

    Where a walker has not moved at all, nothing is known, and it is the length of the chain.
    """
    with np.errstate(invalid="ignore"):
        tau: Any = emcee.autocorr.integrated_time(chain, tol=0)
    return np.nan_to_num(np.asarray(tau, dtype=np.float64), nan=float(len(chain)))
