"""Terms of a cost model as a user writes them: ``draw_calls,max(triangles,shaded_samples)``.

A term is a predictor, a product of predictors such as ``draw_calls*triangles``, a knee
``knee(triangles,158000)``, what a frame's total is beyond a number, or one roofline
``max(geometry, pixels)`` whose sides are sums such as ``vertices+triangles``.  A predictor may be
one type's alone, ``triangles[tree]``, where the log has such a column.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from ...base.errors import InputError
from ...models.machine.knee import Knee
from ...traces.logs.render_log import COUNTS

_NAME = re.compile(r"([a-z_]+)(\[[^\[\],]+\])?")


@dataclass(frozen=True, slots=True)
class Term:
    """One term of the mean.

    Attributes
    ----------
    kind : "linear", "product", "knee" or "roofline"
    predictors : the predictor; the factors; the geometry side and last the pixel side
    at : of a knee, from where on it costs
    """

    kind: Literal["linear", "product", "knee", "roofline"]
    predictors: tuple[str, ...]
    at: float = 0.0

    def __str__(self) -> str:
        if self.kind == "knee":
            return Knee(self.predictors[0], self.at, 0.0).name
        if self.kind == "roofline":
            return f"max({'+'.join(self.predictors[:-1])},{self.predictors[-1]})"
        return "*".join(self.predictors)


def parse_terms(text: str) -> tuple[Term, ...]:
    """Return the terms in `text`.

    Raises `InputError` if a term is empty, repeated, or names no predictor; or if there are two
    rooflines.
    """
    pieces = [piece.strip() for piece in re.split(r",(?![^(\[]*[)\]])", text)]
    terms = tuple(_parse(piece, text) for piece in pieces)
    if len(set(terms)) != len(terms):
        raise InputError(f"--terms: expected each term once, got {text}")
    if sum(term.kind == "roofline" for term in terms) > 1:
        raise InputError(f"--terms: expected one roofline max(…, …) at most, got {text}")
    return terms


def _parse(piece: str, text: str) -> Term:
    roofline = re.fullmatch(r"max\((.*),(.*)\)", piece.replace(" ", ""))
    if roofline:
        sides = (*roofline[1].split("+"), roofline[2])
        return Term("roofline", tuple(_known(name, text) for name in sides))
    knee = re.fullmatch(r"knee\((.*),(.*)\)", piece.replace(" ", ""))
    if knee:
        try:
            at = float(knee[2])
        except ValueError:
            at = -1.0
        if not 0.0 < at < float("inf"):
            raise InputError(f"--terms: expected a number above 0 in {piece}, got {knee[2]}")
        return Term("knee", (_known(knee[1], text),), at)
    factors = tuple(_known(name.strip(), text) for name in piece.split("*"))
    return Term("linear" if len(factors) == 1 else "product", factors)


def _known(name: str, text: str) -> str:
    match = _NAME.fullmatch(name)
    if match is None or match[1] not in COUNTS:
        raise InputError(
            f"--terms: expected predictors among {', '.join(COUNTS)}, products a*b, "
            f"knee(triangles,158000), or max(triangles,shaded_samples); got {name or 'nothing'} "
            f"in {text!r}"
        )
    return name


def predictors_of(terms: Sequence[Term]) -> tuple[str, ...]:
    """Return the predictors that terms use, each once, in order."""
    return tuple(dict.fromkeys(name for term in terms for name in term.predictors))
