"""From a fit to a hardware profile, and on to a replay."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from lodbench.analysis.fit.fit import Fit, FitOptions, Source, fit_logs, target_of
from lodbench.analysis.fit.fit_document import fit_record
from lodbench.analysis.fit.fit_frames import Sample
from lodbench.analysis.fit.fitted_profile import profile_of, require_for_profile
from lodbench.analysis.fit.sampling.sampler import SamplerOptions
from lodbench.analysis.fit.terms import parse_terms
from lodbench.base.errors import InputError
from lodbench.base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from lodbench.models.machine.hardware import Display
from lodbench.models.machine.profile_file import parse_profile
from lodbench.models.machine.profile_writer import profile_toml
from lodbench.traces.logs.render_log import RenderLog, TimeName

MakeSample = Callable[..., Sample]

DRAWS, TRIANGLES = GPU_PREDICTORS.index("draw_calls"), GPU_PREDICTORS.index("triangles")


def log_of(sample: Sample, target: TimeName = "gpu_ms", **more: object) -> RenderLog:
    """Return the sample as a log."""
    log = RenderLog("walk", "csv", sample.names, sample.predictors, gpu_ms=sample.time_ms)
    times = {"gpu_ms": None, target: sample.time_ms}
    return dataclasses.replace(log, **times, **more)  # pyright: ignore[reportArgumentType]  # by name


def fitted(
    log: RenderLog, terms: str, target: TimeName = "gpu_ms", model: str = "student-t"
) -> Fit:
    """Fit a log with a short chain."""
    name = "student-t" if model == "student-t" else "gaussian"
    options = FitOptions(terms, name, "none", 0, SamplerOptions(max_steps=500))
    return fit_logs([Source(log, "f" * 64)], target, options)


@pytest.fixture(scope="module")
def gpu_fit(make_sample: MakeSample) -> Fit:
    """Fit gpu_ms of a clean log of 300 frames at 800 x 600."""
    header = (("renderer", "card"), ("resolution", "800x600"), ("date", "2024-05-06"))
    return fitted(log_of(make_sample(frames=300), header=header), "draw_calls,triangles")


def test_the_profile_holds_means_draws_and_where_they_come_from(gpu_fit: Fit):
    """Posterior means to six digits, 64 draws, hash, rows, renderer, date and viewport."""
    profile = profile_of(gpu_fit, "mine")
    mean = gpu_fit.coefficients.mean(axis=0)
    assert profile.name == "mine"
    assert profile.gpu.base_ms == pytest.approx(mean[0], rel=1e-5)
    assert profile.gpu.linear_ms[[DRAWS, TRIANGLES]] == pytest.approx(mean[1:], rel=1e-5)
    assert profile.posterior is not None
    assert len(profile.posterior) == 64
    spread = profile.posterior.linear_ms[:, TRIANGLES].std()
    assert spread == pytest.approx(gpu_fit.coefficients[:, 2].std(), rel=0.35)
    assert profile.provenance.source == "walk (sha256 ffffffffffff)"
    assert profile.provenance.renderer == "card"
    assert profile.provenance.date == "2024-05-06"
    assert "300 frames worth" in profile.provenance.method
    assert (profile.display.width_px, profile.display.height_px) == (800, 600)
    assert profile.frames_in_flight == 2
    assert not profile.cpu.linear_ms.any()


RECORDED = (
    ("renderer", "card"),
    ("driver", "4.5"),
    ("processor", "chip, 2 cores"),
    ("scene", "plaza"),
    ("trace", "tour"),
)


def test_the_profile_says_on_what_machine_and_of_what_it_was_measured(make_sample: MakeSample):
    """Scene and trace of a recorded log are kept, so that it is not validated on them."""
    log = log_of(make_sample(frames=300))
    calibration = dataclasses.replace(log, header=(*RECORDED, ("policy", "calibration")))
    said = profile_of(fitted(calibration, "draw_calls,triangles"), "mine").provenance
    assert said.renderer == "card; 4.5; chip, 2 cores"
    assert said.source == "walk (sha256 ffffffffffff), calibration of plaza along tour"
    assert said.measured_on == ("plaza along tour",)
    replayed = dataclasses.replace(log, header=(*RECORDED, ("policy", "full")))
    said = profile_of(fitted(replayed, "draw_calls,triangles"), "mine").provenance
    assert said.source == "walk (sha256 ffffffffffff), replay of plaza along tour"


def test_a_profile_of_parts_was_measured_on_what_each_part_was(
    make_sample: MakeSample, gpu_fit: Fit
):
    """What the other half was measured on is kept, and each is named once."""
    before = profile_of(gpu_fit, "before")
    assert before.provenance.measured_on == ()
    for_gpu = dataclasses.replace(
        before.provenance, measured_on=("market along walk", "plaza along tour")
    )
    before = dataclasses.replace(before, provenance=for_gpu)
    log = log_of(make_sample(frames=300), "cpu_ms", header=RECORDED)
    both = profile_of(fitted(log, "draw_calls", "cpu_ms"), "both", onto=before)
    assert both.provenance.measured_on == ("market along walk", "plaza along tour")


def test_the_noise_of_the_profile_is_that_of_the_log(gpu_fit: Fit):
    """0.5 ms about a mean of some 14 ms; draws' scales lie around the profile's."""
    profile = profile_of(gpu_fit, "mine")
    assert profile.gpu_residual.kind == "student-t"
    assert profile.gpu_residual.scale == pytest.approx(0.04, abs=0.015)
    assert profile.gpu_residual.correlation < 0.15
    assert profile.posterior is not None
    middle = float(np.median(profile.posterior.scale))
    assert middle == pytest.approx(profile.gpu_residual.scale, rel=0.1)


def test_the_profile_goes_through_its_file_and_into_a_replay(gpu_fit: Fit):
    """Text and back again, and each draw is a machine of its own."""
    profile = profile_of(gpu_fit, "mine")
    again = parse_profile(profile_toml(profile))
    assert profile_toml(again) == profile_toml(profile)
    first, second = again.truth(0)[0], again.truth(1)[0]
    assert first.linear_ms[TRIANGLES] != second.linear_ms[TRIANGLES]


def test_the_same_fit_gives_the_same_bytes(make_sample: MakeSample, gpu_fit: Fit):
    """No clock and no global state goes into a profile."""
    header = gpu_fit.sources[0].log.header
    again = fitted(log_of(make_sample(frames=300), header=header), "draw_calls,triangles")
    assert profile_toml(profile_of(again, "mine")) == profile_toml(profile_of(gpu_fit, "mine"))


def test_frame_times_have_one_frame_in_flight(make_sample: MakeSample):
    """Where CPU and GPU cannot be told apart nothing overlaps."""
    fit = fitted(log_of(make_sample(), "frame_ms"), "draw_calls,triangles", "frame_ms", "gaussian")
    profile = profile_of(fit, "mine")
    assert profile.frames_in_flight == 1
    assert profile.gpu_residual.kind == "gaussian"


def test_cpu_times_go_onto_a_profile(make_sample: MakeSample, gpu_fit: Fit):
    """The CPU's half is replaced, the GPU's half and the display stay."""
    before = profile_of(gpu_fit, "before")
    fit = fitted(log_of(make_sample(), "cpu_ms"), "draw_calls", "cpu_ms")
    profile = profile_of(fit, "both", onto=before)
    assert profile.cpu.base_ms > 0.0
    assert profile.cpu.linear_ms[CPU_PREDICTORS.index("draw_calls")] > 0.0
    assert profile.gpu == before.gpu
    assert profile.posterior == before.posterior
    assert profile.display == before.display
    assert "the rest is that of before" in profile.provenance.method


@pytest.mark.parametrize("said", ["", "800", "0x600", "²x3", "800 by 600"])
def test_a_resolution_that_is_none_leaves_the_display(make_sample: MakeSample, said: str):
    """Headers are anybody's."""
    log = log_of(make_sample(), header=(("resolution", said),))
    profile = profile_of(fitted(log, "draw_calls"), "plain")
    assert profile.display == Display()


def test_a_roofline_goes_into_the_profile_with_its_draws(make_sample: MakeSample):
    """Both sides, and draws of both."""
    frames = make_sample(frames=200)
    shaded = np.random.default_rng(1).uniform(0.0, 2e6, 200)
    log = log_of(
        Sample(
            (*frames.names, "shaded_samples"),
            np.column_stack([frames.predictors, shaded]),
            frames.time_ms + 5e-6 * np.maximum(shaded - frames.predictors[:, 1], 0.0),
            frames.series,
        )
    )
    profile = profile_of(fitted(log, "draw_calls,max(triangles,shaded_samples)"), "roof")
    samples = GPU_PREDICTORS.index("shaded_samples")
    assert profile.gpu.has_roofline
    assert profile.gpu.roofline_ms[[TRIANGLES, samples]] == pytest.approx([5e-6, 5e-6], rel=0.1)
    drawn = profile.truth(3)[0].roofline_ms[TRIANGLES]
    assert drawn != profile.gpu.roofline_ms[TRIANGLES]
    assert drawn == pytest.approx(5e-6, rel=0.2)


@pytest.mark.parametrize(
    ("terms", "target", "says"),
    [
        ("draw_calls*triangles", "gpu_ms", r"got draw_calls\*triangles"),
        ("triangles[tree]", "gpu_ms", r"got triangles\[tree\]"),
        ("max(triangles,vertices)", "gpu_ms", r"got max\(triangles,vertices\)"),
        ("triangles", "cpu_ms", "a profile of cpu_ms can hold.*got triangles"),
        ("max(triangles,shaded_samples)", "cpu_ms", r"got max\("),
    ],
)
def test_terms_that_a_profile_cannot_hold_are_refused(terms: str, target: TimeName, says: str):
    """Before the work, by name."""
    with pytest.raises(InputError, match=says):
        require_for_profile(parse_terms(terms), target)


def test_a_coefficient_for_each_type(make_sample: MakeSample):
    """Columns of one type's triangles have coefficients of their own."""
    frames = make_sample(frames=200)
    trees = np.random.default_rng(2).uniform(0.0, 1e6, 200)
    log = log_of(
        Sample(
            ("triangles[house]", "triangles[tree]"),
            np.column_stack([frames.predictors[:, 1], trees]),
            4.0 + 5e-6 * frames.predictors[:, 1] + 2e-5 * trees,
            frames.series,
        )
    )
    fit = fitted(log, "triangles[house],triangles[tree]")
    assert fit.coefficients.mean(axis=0) == pytest.approx([4.0, 5e-6, 2e-5], rel=0.02)


def test_the_time_to_fit_is_the_gpus_or_else_the_frames(make_sample: MakeSample):
    """A software rasteriser's timer is passed over; with neither time the reason is given."""
    frames = make_sample()
    both = dataclasses.replace(log_of(frames), frame_ms=frames.time_ms)
    assert target_of(both) == "gpu_ms"
    assert target_of(dataclasses.replace(both, header=(("renderer", "llvmpipe"),))) == "frame_ms"
    with pytest.raises(InputError, match="got a log with cpu_ms; name it with --target"):
        target_of(log_of(frames, "cpu_ms"))


def test_the_record_has_what_the_design_promises(gpu_fit: Fit):
    """Keys of the JSON document, and numbers in the unit that is named."""
    record = fit_record(gpu_fit)
    assert set(record) >= {
        "schema",
        "log",
        "target",
        "rows",
        "rows_rejected",
        "coefficients",
        "noise",
        "diagnostics",
        "heldout",
    }
    triangles = record["coefficients"]["triangles"]
    assert set(triangles) >= {"mean", "sd", "q05", "q50", "q95", "unit"}
    assert triangles["unit"] == "ns"
    assert triangles["mean"] == pytest.approx(1e6 * gpu_fit.coefficients[:, 2].mean(), rel=1e-5)
    assert set(record["diagnostics"]) >= {"acceptance", "autocorr_time", "r_hat", "ess"}
    assert record["heldout"] is None
