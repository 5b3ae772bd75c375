"""What a validation says of replays whose truth is known: simulated ones stand for recordings."""

from collections.abc import Callable
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from lodbench.analysis.study.compare import CompareSettings
from lodbench.analysis.study.score import Scored
from lodbench.analysis.validation.replays import simulate_all
from lodbench.analysis.validation.validate import (
    Measured,
    Pair,
    Simulated,
    Simulation,
    require_other_frames,
    require_priced,
    validate,
)
from lodbench.analysis.validation.validation_page import render_validation
from lodbench.analysis.validation.validation_result import Validation
from lodbench.base.errors import InputError
from lodbench.base.files.strict_json import encode_record
from lodbench.base.predictors import GPU_PREDICTORS
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.hardware import HardwareProfile, Posterior
from lodbench.models.machine.residual import Residual
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.frame_log import UNLOGGED, FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.generators.tour import tour

LABELS = ("full", "static-screen", "feedback")
COSTS = {"triangles": 1e-4, "rasterized_triangles": 5e-5, "draw_calls": 1e-3}
Replays = tuple[Validation, dict[str, Pair], HardwareProfile]


def counts_of(log: FrameLog) -> dict[str, np.ndarray]:
    """Return what a frame log says was drawn."""
    return {name: log[name] for name in GPU_PREDICTORS if name not in UNLOGGED}


@pytest.fixture(scope="module")
def replays(make_hardware_once: Callable[[float], HardwareProfile]) -> Replays:
    """Validate a profile on a machine that is one tenth slower than it says."""
    profile, slower = make_hardware_once(1.0), make_hardware_once(1.1)
    scene = load_scene("plaza")
    trace = tour((0.0, 0.0, 0.0), (200.0, 200.0)).stretch(0.0, 2.5)
    options = ReplayOptions(budget_ms=20.0)
    again = replace(options, seed=5)
    settings = CompareSettings(workers=1, draws=4, warmup_s=0.5)
    simulation = simulate_all(LABELS, scene, trace, profile, options, settings)
    pairs: dict[str, Pair] = {}
    for label in LABELS:
        logs = [
            replay(parse_policy(label).make(), scene, trace, slower, chosen, name=label)
            for chosen in (options, again)
        ]
        measured = tuple(Measured(log, counts_of(log)) for log in logs)
        pairs[label] = Pair(measured, simulation.policies[label].log)
    log = {"renderer": "none", "resolution": "640x360", "date": "2026-01-01"}
    return validate(simulation, pairs, profile, log), pairs, profile


@pytest.fixture(scope="module")
def make_hardware_once() -> Callable[[float], HardwareProfile]:
    """Return a maker of profiles whose costs are so many times `COSTS`, with noise of 2 %."""
    from lodbench.models.machine.cost import CpuCostModel
    from lodbench.models.machine.hardware import Display, Provenance

    def make(factor: float) -> HardwareProfile:
        model = CostModel.of(1.0 * factor, {name: factor * ms for name, ms in COSTS.items()})
        draws = np.linspace(0.95, 1.05, 8)[:, None] * model.linear_ms
        return HardwareProfile(
            "made-up",
            Provenance("a test", measured_on=("plaza along nowhere",)),
            model,
            CpuCostModel.of(0.0, {}),
            Residual("gaussian", 0.02),
            posterior=Posterior(np.full(8, factor), draws, np.full(8, 0.02)),
            display=Display("immediate", width_px=640, height_px=360),
            frames_in_flight=1,
        )

    return make


def test_a_machine_that_is_a_tenth_slower_is_underestimated_by_a_tenth(replays: Replays) -> None:
    """1 / 1.1 - 1 is -9.1 %, frame by frame, for every policy, and gone once adapted."""
    validation, _, _ = replays
    for policy in validation.policies:
        assert policy.errors.model.mean_pct == pytest.approx(100.0 / 1.1 - 100.0, abs=0.8)
        assert policy.errors.model.sd_pct == pytest.approx(2.0 / 1.1, rel=0.4)
        assert abs(policy.errors.v_time.mean_pct) < 0.8
    assert validation.all_policies.model.frames == sum(
        policy.errors.model.frames for policy in validation.policies
    )


def test_a_second_recording_shows_the_noise_alone(replays: Replays) -> None:
    """Full detail heeds no time, so that recordings differ by two noises of 2 % alone."""
    again = next(p for p in replays[0].policies if p.label == "full").errors.again
    assert again is not None
    assert abs(again.mean_pct) < 1.0
    assert 1.5 < again.sd_pct < 4.5


def test_policies_are_ordered_alike(replays: Replays) -> None:
    """A machine that is slower by the same share orders these policies as the profile does."""
    validation, _, _ = replays
    assert validation.ranks["frame_ms_mean"].simulated == pytest.approx(1.0)
    assert validation.ranks["frame_ms_mean"].again == pytest.approx(1.0)


def test_inside_is_what_lies_between_the_ends(replays: Replays) -> None:
    """Each metric is inside exactly where its measured value is from low to high."""
    validation, _, _ = replays
    known = [
        item for policy in validation.policies for item in policy.metrics.values()
        if item.inside is not None
    ]  # fmt: skip
    assert len(known) > 20
    for item in known:
        assert item.measured is not None
        assert item.low is not None
        assert item.high is not None
        assert item.inside == (item.low <= item.measured <= item.high)
    assert validation.inside == pytest.approx(np.mean([bool(item.inside) for item in known]))


def test_the_record_comes_back_from_its_json(replays: Replays) -> None:
    """The JSON begins with its schema and holds every field."""
    text = encode_record(replays[0])
    assert text.startswith(b'{\n "schema": "lodbench.validate/2"')
    assert msgspec.json.decode(text, type=Validation) == replays[0]


def test_the_page_names_every_policy_and_holds_its_charts(replays: Replays) -> None:
    """The page has both charts, every label, and no placeholder that nothing filled."""
    validation, pairs, _ = replays
    page = render_validation(validation, pairs)
    for part in (*LABELS, 'id="chart-series"', 'id="chart-agreement"', "frame_ms_sd"):
        assert part in page
    assert "$series" not in page


def test_frames_that_were_calibrated_on_are_refused(replays: Replays) -> None:
    """A profile is not validated on the scene and trace that it comes from."""
    profile = replays[2]
    require_other_frames(profile, "plaza", "tour")
    with pytest.raises(InputError, match="expected a profile calibrated on other frames"):
        require_other_frames(profile, "plaza", "nowhere")


def test_what_cannot_be_priced_is_refused(replays: Replays) -> None:
    """A profile with a roofline, or with a cost of what is not recorded, is named."""
    profile = replays[2]
    require_priced(profile)
    with pytest.raises(InputError, match="got one of splats"):
        require_priced(replace(profile, gpu=CostModel.of(0.0, {"splats": 1.0})))
    with pytest.raises(InputError, match="got a roofline"):
        require_priced(replace(profile, gpu=CostModel.of(0.0, {}, {"triangles": 1.0})))


def test_a_recording_of_warm_up_alone_is_refused(
    replays: Replays, made_scored: Callable[..., Scored]
) -> None:
    """A recording that ends before the window has nothing to compare, and says so."""
    validation, pairs, profile = replays
    simulated = pairs["full"].simulated
    early = simulated["input_ns"] < 0.5e9
    short = FrameLog(simulated.header, simulated.times_ns[early], simulated.counts[early])
    assert validation.window_s == (0.5, 2.5)
    scored = Simulated(made_scored(), ())
    simulation = Simulation("plaza", "tour", 2.5, 20.0, 0, (0.5, 2.5), {"full": scored})
    pair = Pair((Measured(short, counts_of(short)),), simulated)
    with pytest.raises(
        InputError, match=r"frame that begins in 0.5 to 2.5 s of the path, got none"
    ):
        validate(simulation, {"full": pair}, profile, {})
