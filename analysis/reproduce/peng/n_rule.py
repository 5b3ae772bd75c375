"""Section 6.2: N such that the farthest character is at the coarsest level."""

from collections.abc import Mapping, Sequence

from ..experiment import Chart, Claim, Constant, Experiment, Findings, Line, error_pct, verdict_of
from ..trial import Numbers, Trial, trial
from .crowds import PIPELINE
from .printed import COARSEST_TRIANGLES, TABLE_1, TABLE_2

_PRINTED = {row.instances: row.triangles for row in (*TABLE_1, *TABLE_2)}
_LARGE, _TOLERANCE_PCT = 1_024, 15.0
_PLACES = ("corner", "edge")


def _sizes(reduced: bool) -> Sequence[int]:
    return (32, 1_024, 2_048) if reduced else tuple(_PRINTED)


def _trials(reduced: bool) -> list[Trial]:
    return [
        trial(
            f"{place} {instances}",
            "peng.crowds:with_coarsest",
            {"instances": instances, "place": place},
        )
        for place in _PLACES
        for instances in _sizes(reduced)
    ]


def _judge(numbers: Mapping[str, Numbers], reduced: bool) -> Findings:
    sizes = _sizes(reduced)
    ours = {
        place: [float(numbers[f"{place} {n}"]["triangles"]) for n in sizes] for place in _PLACES
    }
    errors = {
        place: [error_pct(t, _PRINTED[n]) for t, n in zip(some, sizes, strict=True)]
        for place, some in ours.items()
    }
    claims = tuple(
        claim
        for place in _PLACES
        for claim in (
            _claim(place, [n for n in sizes if n >= _LARGE], sizes, errors[place]),
            _claim(place, [n for n in sizes if n < _LARGE], sizes, errors[place]),
        )
    )
    largest = TABLE_2[-1]
    each = largest.triangles / largest.instances
    seen = [numbers[f"{place} {sizes[-1]}"]["in_view"] / sizes[-1] for place in _PLACES]
    notes = (
        (
            "Below some 1,000 characters more triangles are printed than keep the farthest one at "
            f"the coarsest level shown, of {COARSEST_TRIANGLES}: N was chosen larger there, which "
            "a text that calls it arbitrary allows."
        ),
        (
            f"For {largest.instances:,} characters the paper prints {each:.1f} triangles each, "
            f"fewer than its coarsest, so that many of them were out of view.  How many is not "
            f"printed and decides the answer: here {100.0 * seen[0]:.0f} % are in view from the "
            f"corner and {100.0 * seen[1]:.0f} % from the edge, of {sizes[-1]:,}."
        ),
    )
    return Findings(claims, (_chart(sizes, ours),), notes)


def _chart(sizes: Sequence[int], ours: Mapping[str, Sequence[float]]) -> Chart:
    x = [float(n) for n in sizes]
    return Chart(
        name="triangles",
        caption="Triangles drawn when the farthest character is at its coarsest: near the printed "
        "ones in large crowds, several times fewer in small ones.",
        x="characters",
        y="triangles",
        lines=(
            Line("printed", x, [float(_PRINTED[n]) for n in sizes], printed=True),
            *(Line(f"camera at the {place}", x, some) for place, some in ours.items()),
        ),
        log_x=True,
        log_y=True,
    )


def _claim(
    place: str, wanted: Sequence[int], sizes: Sequence[int], errors: Sequence[float]
) -> Claim:
    of = {n: error for n, error in zip(sizes, errors, strict=True) if n in wanted}
    listed = ", ".join(f"{error:+.0f} %" for error in of.values())
    span = f"{min(wanted):,} to {max(wanted):,}" if len(wanted) > 1 else f"{wanted[0]:,}"
    holds = max(map(abs, of.values())) <= _TOLERANCE_PCT
    return Claim(
        f"triangles with the farthest character at its coarsest, {span} characters, camera at the "
        f"{place}",
        " to ".join(f"{_PRINTED[n]:,}" for n in dict.fromkeys((min(wanted), max(wanted)))),
        listed,
        f"{_TOLERANCE_PCT:g} %",
        verdict_of(holds, "N was set by hand, and how many characters were in view is not printed"),
    )


N_RULE = Experiment(
    id="peng/n-rule",
    title="How many vertices to share",
    setting=f"crowd-32 to crowd-32768, one frame each on {PIPELINE}; N such that equation 1 gives "
    "the character of the least area the vertices of the coarsest level.",
    constants={
        "alpha": Constant("3", "printed", "section 6.2"),
        "triangles of the coarsest level": Constant(str(COARSEST_TRIANGLES), "printed", "Fig. 3"),
        "camera": Constant("8 m beyond a corner or an edge, 6 m up, 12 degrees down", "assumed"),
        "characters": Constant("1.5 m apart on a square", "assumed"),
    },
    trials=_trials,
    judge=_judge,
)
