"""The result of a check: the record behind its text, its JSON, JUnit XML and annotations."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

from ...base.html_table import html_table
from ..verdict.paired import decide
from .baseline import Baseline
from .evidence import Question, find, questions_of
from .judgement import Outcome, Verdict, conclude, judge_failure
from .limits import LimitRules
from .measurements import Conditions, MeasuredPolicy

if TYPE_CHECKING:
    import pyarrow as pa

SCHEMA = "lodbench.check/2"


_COLUMNS = (
    *("policy", "scene", "metric", "population", "outcome", "limit"),
    *("value", "bound", "unit", "p", "needed", "reason"),
)


@dataclass(frozen=True, slots=True, repr=False)
class CheckReport:
    """Verdicts on all limits, without any wall-clock time.

    Attributes
    ----------
    passed : bool
        No limit failed, and with `strict` none is undecided and every rule was for something.
    unused : tuple of str
        Rules of the limits that were for nothing that ran.
    """

    passed: bool
    strict: bool
    conditions: Conditions
    verdicts: tuple[Verdict, ...]
    unused: tuple[str, ...] = ()
    schema: Literal["lodbench.check/2"] = SCHEMA

    def __repr__(self) -> str:
        counts = ", ".join(f"{self.count(outcome)} {outcome}" for outcome in get_args(Outcome))
        return f"<CheckReport {'passed' if self.passed else 'failed'}: {counts}>"

    def to_table(self) -> "pa.Table":
        """Return one row a limit and policy: what was judged, the outcome, value and reason."""
        import pyarrow as pa

        rows = list(zip(*self._rows(), strict=True)) or [()] * len(_COLUMNS)
        return pa.table(dict(zip(_COLUMNS, rows, strict=True)))

    def _repr_html_(self) -> str:
        return html_table(repr(self)[1:-1], _COLUMNS, self._rows())

    def _rows(self) -> list[list[object]]:
        return [[getattr(item, name) for name in _COLUMNS] for item in self.verdicts]

    def count(self, outcome: str) -> int:
        """Return how many limits have an outcome."""
        return sum(verdict.outcome == outcome for verdict in self.verdicts)

    def is_failure(self, verdict: Verdict) -> bool:
        """Whether a verdict fails the check."""
        return verdict.outcome == "fails" or (self.strict and verdict.outcome == "undecided")


def judge_all(
    limits: LimitRules,
    measured: Sequence[MeasuredPolicy],
    conditions: Conditions,
    baseline: Baseline | None,
    *,
    strict: bool = False,
    allow_new: bool = False,
) -> CheckReport:
    """Judge every limit on everything measured, all together, in the order of both.

    Raises `InputError` if a limit has too few paths or seeds for its population.

    Parameters
    ----------
    baseline
        None where there is none: then what is relative to it fails.
    allow_new
        What the baseline lacks passes.
    """
    asked = [_questions(limits, item) for item in measured]
    questions = [question for each in asked for question in each]
    findings = [find(question, conditions, baseline, len(questions)) for question in questions]
    judged = iter(
        [
            conclude(question, finding, judgement, conditions, allow_new=allow_new)
            for question, finding, judgement in zip(
                questions, findings, decide([one.evidence for one in findings]), strict=True
            )
        ]
    )
    verdicts: list[Verdict] = []
    for item, each in zip(measured, asked, strict=True):
        verdicts += [judge_failure(item)] if item.reason is not None else []
        verdicts += [next(judged) for _ in each]
    unused = _unused(limits, measured)
    wrong = {"fails", "undecided"} if strict else {"fails"}
    passed = not any(verdict.outcome in wrong for verdict in verdicts)
    passed = passed and not (strict and (unused or not verdicts))
    return CheckReport(passed, strict, conditions, tuple(verdicts), unused)


def _questions(limits: LimitRules, item: MeasuredPolicy) -> list[Question]:
    if item.reason is not None:
        return []
    return questions_of(item, [limits.of(item.policy, item.scene, path) for path in item.paths])


def _unused(limits: LimitRules, measured: Sequence[MeasuredPolicy]) -> tuple[str, ...]:
    ran = [(item.policy, item.scene, path) for item in measured for path in item.paths]
    return tuple(
        f"policy {rule.policy}, scene {rule.scene}, trace {rule.trace}"
        for rule in limits.rules
        if rule.limits and not any(rule.covers(*names) for names in ran)
    )
