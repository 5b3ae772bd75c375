"""What a reader should take from each section: a sentence that is true of the record, by hand."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from lodbench.analysis.metrics.worst_moment import Moment
from lodbench.analysis.report.blocks import Cell, Paragraph, Picture, Pictures, Plots, Table
from lodbench.analysis.report.palette import inks
from lodbench.analysis.report.render import SECTIONS, find_section, render_report
from lodbench.analysis.report.results import Results
from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.analysis.study.comparison_parts import Score
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace

A, B = "static-screen:bias=1", "full"
FRAMES = 100


@pytest.fixture(scope="module")
def compared(small_scene: Scene, turn_trace: CameraTrace, machine: HardwareProfile) -> Compared:
    """Return a comparison of two policies."""
    policies = [parse_policy(text) for text in (A, B)]
    settings = CompareSettings(workers=1, warmup_s=0.2, seeds=1)
    return compare(policies, small_scene, [turn_trace], machine, ReplayOptions(budget_ms=8.0),
                   settings)  # fmt: skip


@pytest.fixture
def results(compared: Compared, make_log: Callable[..., FrameLog]) -> Results:
    """Return it with a path of a second, made by hand: 100 frames of 10 ms.

    A has the first rank, and B none.  A takes 4 ms but 12 ms in the frames that begin at 0.10 and
    0.11 s, and shows 5 pops; it predicts 4 ms.  B takes 20 ms, and 21 ms at 0.90 s.
    """
    gpu_a, gpu_b, pops = np.full(FRAMES, 4.0), np.full(FRAMES, 20.0), np.zeros(FRAMES)
    gpu_a[10:12], gpu_b[90], pops[:5] = 12.0, 21.0, 1.0
    logs = {
        A: make_log(gpu_ms=gpu_a, visible_pops=pops, predicted_gpu_ms=4.0, policy=A),
        B: make_log(gpu_ms=gpu_b, visible_pops=0.0, policy=B),
    }
    moments = {
        A: Moment("p", 0.5, (0.0, 0.0, 0.0), 12.0, 4.0, "draw_calls", 7.5),
        B: Moment("p", 0.9, (0.0, 0.0, 0.0), 21.0, 20.0, "", 0.0),
    }
    by_label = {policy.label: policy for policy in compared.comparison.policies}
    comparison = replace(
        compared.comparison,
        policies=(replace(by_label[A], rank=1), replace(by_label[B], rank=None)),
        window_s=((0.0, 1.0),),
        worst_moments=moments,
    )
    return Results(comparison, logs, inks(comparison), pictures={A: b"png"})


@pytest.mark.parametrize(
    ("section", "sentence"),
    [
        ("ranks", f"1 of 2 policies surely keeps the budget; the first rank is {A}'s."),
        (
            "along_the_trace",
            f"{A} is over the budget for 2.00 % of the time of this path; 0 of 2 policies never.",
        ),
        (
            "slow_frames",
            (
                f"For 99 % of the time {A} works 12.0 ms a frame or less on this path; {B}, the "
                "slowest, 20.0 ms."
            ),
        ),
        ("flicker", f"{A} shows 5.00 visible pops a second on this path, and nobody more."),
        (
            "cost_breakdown",
            (
                f"Of the 4.16 ms of GPU time in a mean frame of {A} most, 4.16 ms, is for what "
                "every frame costs."
            ),
        ),
        (
            "worst_moments",
            (
                f"{A}, the first of the ranking, never took longer than 12.0 ms, 1.50 × the "
                "budget; 2 of 2 policies exceeded it at some moment."
            ),
        ),
        ("from_above", f"{A} did most work 0.10 s into this path."),
    ],
)
def test_a_section_says_what_is_true(results: Results, section: str, sentence: str) -> None:
    """Each number is worked from the frames that the fixture makes."""
    assert find_section(section)(results).takeaway == sentence


def test_a_place_that_is_hard_for_others_too_is_told(results: Results) -> None:
    """Had B done most work at 0.9 s as well as A, the sentence would say so."""
    log = results.logs[B]
    both = replace(results, logs={A: log, B: log})
    assert find_section("from_above")(both).takeaway == (
        f"{A} did most work 0.90 s into this path; 1 of 1 other policy within 0.5 s of it."
    )


def test_who_steps_least_and_most_is_named(results: Results) -> None:
    """By the mean over steps; without a step the section says that there is none."""
    step = next(step for policy in results.comparison.ok for step in policy.steps)
    first, last = results.comparison.policies
    policies = (
        replace(first, steps=(replace(step, overshoot_ratio=0.5),) * 2),
        replace(last, steps=(replace(step, overshoot_ratio=2.0), replace(step, overshoot_ratio=3))),
    )
    stepped = replace(results, comparison=replace(results.comparison, policies=policies))
    assert find_section("load_steps")(stepped).takeaway == (
        f"After 2 steps in load the work of {A} rises to 0.500 × the budget on average, the "
        f"least; that of {B} to 2.50 ×, the most."
    )
    even = tuple(replace(policy, steps=()) for policy in results.comparison.policies)
    calm = replace(results, comparison=replace(results.comparison, policies=even))
    assert find_section("load_steps")(calm).takeaway == ""


def test_predictions_stand_beside_what_was_charged(results: Results) -> None:
    """98 frames as predicted, two at 12 ms of which 4 were: -66.7 %, -1.33 on average.

    The record holds no measurement, and says so; who predicts nothing has no row.
    """
    plots, table, said = find_section("predictions")(results).blocks
    assert isinstance(plots, Plots)
    assert [plot.name for plot in plots.plots] == ["simulated", "predicted"]
    assert isinstance(table, Table)
    (row,) = table.rows
    assert isinstance(row, tuple)
    cells = [cell for cell in row if isinstance(cell, Cell)]
    assert [cell.text for cell in cells[:5]] == [A, "4.00", "4.16", "-1.33 ± 9.33", "98 %"]
    assert isinstance(said, Paragraph)
    assert said.text.startswith("Measured: nothing in this record; no machine drew these frames.")
    assert "docs/validation.md" in said.text


def test_the_nearest_prediction_is_named(results: Results) -> None:
    """By the error over all judged paths; equal ones are not told apart."""

    def told(*errors: float | None) -> str:
        policies = tuple(
            replace(
                policy,
                metrics=policy.metrics
                | {
                    "prediction_error_pct_mean": Score(
                        error, None, None, None, enough=True, needed=None, unit="%", better="lower"
                    )
                },
            )
            for policy, error in zip(results.comparison.policies, errors, strict=True)
        )
        changed = replace(results, comparison=replace(results.comparison, policies=policies))
        return find_section("predictions")(changed).takeaway

    assert told(3.0, 2.0) == (
        f"{B} predicts a frame's GPU time to 2.00 % on average, the nearest; {A} to 3.00 %, the "
        "farthest."
    )
    assert told(3.0, 3.001) == "2 policies predict a frame's GPU time to 3.00 % on average."
    assert told(3.0, None) == f"{A} predicts a frame's GPU time to 3.00 % on average."
    assert told(None, None) == ""


def test_a_worst_moment_has_time_camera_and_what_had_grown(results: Results) -> None:
    """Beside its picture; who has no picture stands in the table alone."""
    beside, table = find_section("worst_moments")(results).blocks
    assert isinstance(beside, Pictures)
    (picture,) = beside.pictures
    assert isinstance(picture, Picture)
    assert picture.name.text == A
    assert picture.alt == f"What the camera saw at 0.50 s of p as {A} drew it"
    assert picture.caption == (
        "12.0 ms, 1.50 × the budget, at 0.50 s of p; what had grown: draw calls, + 7.50 ms"
    )
    assert isinstance(table, Table)
    assert len(table.rows) == 2


def test_the_load_of_the_path_is_drawn_whatever_the_legend_hides(compared: Compared) -> None:
    """One line above all that is zoomed with it, which belongs to no policy."""
    page = render_report(compared.comparison, compared.logs, compared.scene)
    load = page[page.index('id="chart-load"') : page.index('id="chart-work"')]
    assert load.count('<path class="line') == 1
    assert "data-p=" not in load
    assert 'data-link="time"' in load


def test_nearly_every_section_has_its_sentence(compared: Compared) -> None:
    """Captions of charts say it where a section has none of its own; facts need none."""
    shown = Results(compared.comparison, compared.logs, inks(compared.comparison), compared.scene)
    without = {name for name in SECTIONS if not find_section(name)(shown).takeaway}
    assert without == {"the_answer", "tradeoffs", "robustness", "predictions", "every_metric",
                       "provenance"}  # fmt: skip
