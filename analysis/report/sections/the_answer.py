"""The answer in words, and what to know before it is believed."""

import shlex
from collections.abc import Iterator

from ...export.engines import ENGINES
from ...study.comparison import Comparison
from ...study.comparison_parts import PolicyResult, knob_text
from ..blocks import Block, Command, Paragraph, Tile, Tiles
from ..results import Results, section
from ..summary import describe_paths, unscored
from ..values import counted, format_value


@section("")
def the_answer(results: Results) -> tuple[Block, ...]:
    """Whom to take, how surely, and who cannot keep the budget."""
    comparison = results.comparison
    first, *others = (Paragraph(results.words(sentence)) for sentence in comparison.answer)
    said: list[Block] = [Paragraph(first.text, "lead"), *others]
    leader = next((policy for policy in results.drawn if policy.rank == 1), None)
    if leader is not None:
        line = f"--policy {shlex.quote(policy_spec(leader))}"
        said.append(Command("The policy and its knob, as the command line takes them", line))
        said += _engine_settings(leader)
    if comparison.ok:
        said.append(Tiles(list(_tiles(results, leader))))
    if comparison.conditions.hardware_assumed:
        text = (
            f"The hardware profile {comparison.hardware} is assumed, not measured: the page "
            "compares policies, it does not predict a machine."
        )
        said.append(Paragraph(results.words(text), "warn"))
    said += [Paragraph(results.words(warning), "warn") for warning in comparison.warnings]
    failed = [(status, text) for status, text in unscored(comparison) if status == "failed"]
    said += [Paragraph(results.words(text), status) for status, text in failed]
    return tuple(said)


def policy_spec(policy: PolicyResult) -> str:
    """Return what a command line calls a policy, its knob's value included."""
    knob = knob_text(policy)
    if not knob or knob in policy.label:
        return policy.label
    return f"{policy.label}{',' if '=' in policy.label else ':'}{knob}"


def _engine_settings(leader: PolicyResult) -> Iterator[Command]:
    """Return what gives the policy as settings of each engine that has one of its kind."""
    for name, engine in ENGINES.items():
        if leader.name in engine.policies:
            line = f"lodbench export . --engine {name} --policy {shlex.quote(leader.label)}"
            yield Command(f"As settings of {name}, in the folder of this page", line)


def _tiles(results: Results, leader: PolicyResult | None) -> Iterator[Tile]:
    comparison = results.comparison
    if leader is not None:
        yield _how_sure(comparison, leader)
    c, s = comparison.conditions, comparison.sampling
    paths = results.words(describe_paths(comparison))
    yield Tile(
        "On which paths", (paths,), f"{comparison.population}; {counted(s.seeds, 'seed')} a path"
    )
    warrant = "assumed" if c.hardware_assumed else "measured or published"
    detail = f"{warrant}; {c.display} at {c.refresh_hz:g} Hz, {c.width_px} × {c.height_px} px"
    yield Tile("On which machine", (results.words(comparison.hardware),), detail)
    if leader is not None:
        yield _what_would_change_it(results, leader)


def _how_sure(comparison: Comparison, leader: PolicyResult) -> Tile:
    best = comparison.p_best.get(leader.label)
    keeps = leader.keeps_budget
    assert keeps is not None, "who has a rank keeps the budget"
    kept = f"{keeps.kept} of {keeps.paths} judged paths were kept"
    if keeps.probability is None or best is None:
        return Tile("How sure", (kept,), "of a single replay: nothing is known of others")
    near = comparison.p_near_best.get(leader.label, 0.0)
    detail = f"{kept}; comes first with {best:.2f}, within the margin of the first with {near:.2f}"
    regret = comparison.regret.get(leader.label)
    if regret is not None:
        detail += f"; expected to be {format_value(regret)} px behind the best"
    return Tile("How sure", (f"{keeps.probability:.2f} to keep the budget",), detail)


def _what_would_change_it(results: Results, leader: PolicyResult) -> Tile:
    title, robustness = "What would change it", results.comparison.robustness
    if robustness is None:
        return Tile(title, ("not known",), "no policy has a curve over its knob")
    if robustness.leader != leader.label:
        return Tile(title, ("not known",), "the curves, of fewer paths, put another first")
    low, high = robustness.speed
    changes = [f"a machine slower than {low:.2g} × this one"] if low > _SLOWEST else []
    changes += [f"a machine faster than {high:.2g} × this one"] if high < _FASTEST else []
    for at in robustness.budgets:
        if at.first and leader.label not in at.first:
            changes.append(results.words(f"{at.refresh_hz:g} Hz: {at.first[0]}"))
    if not changes:
        return Tile(title, ("nothing that was tried",), "half to twice the speed, 30 to 120 Hz")
    return Tile(title, changes, "read off the curves")


_SLOWEST, _FASTEST = 0.5, 2.0
"""Speeds of the machine up to which it is looked."""
