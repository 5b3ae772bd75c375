"""What a validation says of replays whose truth is known: simulated ones stand for recordings."""

from collections.abc import Callable
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from lodbench.analysis.validation.recorded_frames import Measured
from lodbench.analysis.validation.replicates import Simulation, require_replicates
from lodbench.analysis.validation.shown.page import render_validation
from lodbench.analysis.validation.validate import (
    Judged,
    judge_case,
    require_other_frames,
    require_priced,
    validate,
)
from lodbench.analysis.validation.validation_result import Validation
from lodbench.base.errors import InputError
from lodbench.base.files.strict_json import encode_record
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.sim.frame_log import FrameLog

pytestmark = pytest.mark.slow

Recordings = dict[str, tuple[Measured, ...]]
LOG = {"renderer": "none", "resolution": "100x100", "date": "2026-01-01"}


@pytest.fixture(scope="module")
def profile(make_machine: Callable[..., HardwareProfile]) -> HardwareProfile:
    """Return the profile that is validated."""
    return make_machine()


@pytest.fixture(scope="module")
def truth(
    recorded: Callable[..., Recordings], make_machine: Callable[..., HardwareProfile]
) -> Recordings:
    """Record them on the machine that it says."""
    return recorded(make_machine(spread=0.0))


@pytest.fixture(scope="module")
def judged(simulation: Simulation, truth: Recordings, profile: HardwareProfile) -> Judged:
    """Judge one path."""
    return judge_case(simulation, truth, profile, LOG)


@pytest.fixture(scope="module")
def validation(judged: Judged, profile: HardwareProfile) -> Validation:
    """Validate one path."""
    return validate([judged], profile, 40, 40)


def test_the_true_profile_is_found_right(validation: Validation) -> None:
    """Errors are noise, decisions are as measured, and nobody is told to calibrate."""
    pooled = validation.pooled
    assert pooled.errors is not None
    assert abs(pooled.errors.model.mean_pct) < 1.5
    assert pooled.errors.excess == pytest.approx(1.0, abs=0.25)
    assert pooled.keeps_budget.asked >= 3
    assert pooled.keeps_budget.as_measured == (
        pooled.keeps_budget.asked - pooled.keeps_budget.undecided
    )
    assert pooled.machine is not None
    assert not pooled.machine.another
    assert pooled.machine.factor == pytest.approx(1.0, abs=0.03)
    assert pooled.ranks["frame_ms_mean"].simulated == pytest.approx(1.0)
    assert not any("calibrate" in sentence for sentence in validation.answer)


def test_errors_of_all_are_those_of_each_together(validation: Validation) -> None:
    """Frames of policies add up to those of their case, and of cases to those of all."""
    case = validation.cases[0]
    frames = sum(policy.errors.model.frames for policy in case.policies)
    assert case.all_policies is not None
    assert validation.pooled.errors is not None
    assert case.all_policies.model.frames == validation.pooled.errors.model.frames == frames


def test_a_machine_of_twice_the_costs_is_named(
    simulation: Simulation,
    recorded: Callable[..., Recordings],
    make_machine: Callable[..., HardwareProfile],
    profile: HardwareProfile,
) -> None:
    """All costs doubled, whatever is drawn: the factor is told, with what to do about it."""
    slow = make_machine(2.0, spread=0.0)
    found = validate([judge_case(simulation, recorded(slow), profile, LOG)], profile, 40, 40)
    machine = found.pooled.machine
    assert machine is not None
    assert machine.another
    assert machine.factor == pytest.approx(2.0, rel=0.05)
    assert "calibrate this machine: lodbench record --calibrate" in found.answer[0]
    share = found.pooled.inside.share
    assert share is not None
    assert share < 0.5


def test_the_share_inside_is_that_of_the_cells_that_count(validation: Validation) -> None:
    """Pooled, by metric and by hand it is the same; lag is not among them."""
    items = [
        (name, item)
        for case in validation.cases
        for policy in case.policies
        for name, item in policy.metrics.items()
        if item.counted
    ]
    inside = validation.pooled.inside
    assert inside.counted == len(items) == sum(of for _, of in inside.by_metric.values())
    assert inside.inside == sum(bool(item.inside) for _, item in items)
    assert "lag_ms_mean" not in inside.by_metric
    for _, item in items:
        assert item.measured is not None
        assert item.low is not None
        assert item.high is not None
        expected = item.low <= item.measured <= item.high
        assert item.inside == expected


def test_frames_drawn_deep_have_their_measured_lag(
    simulated: Callable[..., Simulation],
    recorded: Callable[..., Recordings],
    make_machine: Callable[..., HardwareProfile],
) -> None:
    """Lag is the column that was measured, counts, and is what the pipeline says with F = 3."""
    deep = make_machine(in_flight=3, spread=0.0)
    simulation = simulated(deep, ("static-screen",), 19)
    passed = recorded(deep, ("static-screen",))["static-screen"]
    lag_ms = (passed[0].frames["display_ns"] - passed[0].frames["input_ns"]) * 1e-6
    with_lag = tuple(replace(item, lag_ms=1.5 * lag_ms) for item in passed[:1])
    log = LOG | {"frames_in_flight": "3"}
    expected = judge_case(simulation, {"static-screen": passed[:1]}, deep, log)
    found = judge_case(simulation, {"static-screen": with_lag}, deep, log)
    values = [each.case.policies[0].metrics["lag_ms_mean"] for each in (expected, found)]
    assert found.case.frames_in_flight == 3
    assert values[0].counted
    assert values[0].inside
    assert values[0].measured is not None
    assert values[1].measured == pytest.approx(1.5 * values[0].measured)
    frame = found.case.policies[0].metrics["frame_ms_mean"].measured
    assert frame is not None
    assert values[0].measured > 2.0 * frame  # which one frame in flight would have it equal to
    n = len(passed[0].frames)
    overlapping = replace(passed[0], prepare_ms=np.ones(n), submit_ms=np.ones(n))
    alone = judge_case(simulation, {"static-screen": (overlapping,)}, deep, log)
    assert validate([alone], deep, 19, 19).pooled.errors is None  # no time is one frame's own
    assert validate([alone], deep, 19, 19).pooled.machine is None


def test_detail_is_the_share_of_the_triangles_in_view(validation: Validation) -> None:
    """Full detail draws all of them, and so has no slope; others draw less."""
    by_label = {policy.label: policy.detail for policy in validation.cases[0].policies}
    full, coarse = by_label["full"], by_label["feedback"]
    assert full is not None
    assert coarse is not None
    assert full.share == pytest.approx((1.0, 1.0), abs=0.02)
    assert full.slope_pct is None
    assert coarse.share[1] < 1.0


def test_a_recording_that_is_too_short_fails_its_policy_alone(
    simulation: Simulation, truth: Recordings, profile: HardwareProfile
) -> None:
    """It ends before the window; the others have their results, and it is named with the reason."""
    frames = truth["full"][0].frames
    early = frames["input_ns"] < 0.2e9
    short = FrameLog(frames.header, frames.times_ns[early], frames.counts[early])
    item = Measured(short, {name: v[early] for name, v in truth["full"][0].counts.items()})
    found = judge_case(simulation, {**truth, "full": (item,)}, profile, LOG, {"peng": "it fell"})
    assert {policy.label for policy in found.case.policies} == truth.keys() - {"full"}
    assert found.case.failed.keys() == {"full", "peng"}
    assert "got none of" in found.case.failed["full"]
    answer = validate([found], profile, 40, 40).answer
    assert any(sentence.startswith("full has no result on") for sentence in answer)


def test_a_validation_of_nothing_but_failures_says_so(
    simulation: Simulation, profile: HardwareProfile
) -> None:
    """No policy, no figure, and no error of its own."""
    found = validate(
        [judge_case(simulation, {}, profile, LOG, {"full": "it fell"})], profile, 40, 40
    )
    assert found.pooled.errors is None
    assert found.pooled.machine is None
    assert found.answer == ("full has no result on by-hand along by-hand: it fell.",)
    assert "it fell" in render_validation(found, {})


def test_cases_are_pooled(judged: Judged, profile: HardwareProfile, validation: Validation) -> None:
    """The same case twice has twice the cells, pairs and decisions, and the same shares."""
    twice = validate([judged, judged], profile, 40, 40).pooled
    once = validation.pooled
    assert twice.inside.counted == 2 * once.inside.counted
    assert twice.inside.share == once.inside.share
    assert twice.ranks["frame_ms_mean"].pairs == 2 * once.ranks["frame_ms_mean"].pairs
    assert twice.keeps_budget.asked == 2 * once.keeps_budget.asked


def test_the_record_comes_back_from_its_json(validation: Validation) -> None:
    """The JSON begins with its schema and holds every field."""
    text = encode_record(validation)
    assert text.startswith(b'{\n "schema": "lodbench.validate/3"')
    assert msgspec.json.decode(text, type=Validation) == validation


def test_the_page_names_every_policy_and_holds_its_charts(
    validation: Validation, truth: Recordings, simulation: Simulation
) -> None:
    """All series and metrics are drawn by the page itself, within some hundred kilobytes."""
    series = {
        label: ([item.frames for item in passed], simulation.policies[label].log)
        for label, passed in truth.items()
    }
    page = render_validation(validation, {0: series})
    for part in (*truth, 'id="chart-series-0-3"', 'id="chart-agreement-frame_ms_mean"'):
        assert part in page
    assert len(page) < 400_000  # plotly alone has 4.8 MB
    assert page == render_validation(validation, {0: series})


def test_frames_that_were_calibrated_on_are_refused(profile: HardwareProfile) -> None:
    """A profile is not validated on the scene and trace that it comes from."""
    source = replace(profile.provenance, measured_on=("plaza along nowhere",))
    profile = replace(profile, provenance=source)
    require_other_frames(profile, "plaza", "tour")
    with pytest.raises(InputError, match="expected a profile calibrated on other frames"):
        require_other_frames(profile, "plaza", "nowhere")


def test_what_cannot_be_priced_is_refused(profile: HardwareProfile) -> None:
    """A profile with a roofline, or with a cost of what is not recorded, is named."""
    require_priced(profile)
    with pytest.raises(InputError, match="got one of splats"):
        require_priced(replace(profile, gpu=CostModel.of(0.0, {"splats": 1.0})))
    with pytest.raises(InputError, match="got a roofline"):
        require_priced(replace(profile, gpu=CostModel.of(0.0, {}, {"triangles": 1.0})))


def test_too_few_replicates_are_refused() -> None:
    """The least and the largest of 19 are where nine in ten of one more lie; 18 have no such."""
    require_replicates(19)
    with pytest.raises(InputError, match="--replicates: expected 19 to"):
        require_replicates(18)


def test_replicates_take_the_draws_in_turn_and_a_seed_each(simulation: Simulation) -> None:
    """No two are the same, none is that of the mean, and all policies share them."""
    means = [run.values["frame_ms_mean"] for run in simulation.policies["full"].replicates]
    assert len(set(means)) == len(means) == 40
    assert simulation.draws == 40
    assert np.std([value for value in means if value is not None]) > 0.0
