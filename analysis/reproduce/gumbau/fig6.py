"""Figure 6: the frame rate with and without the manager, and what the difference rests on."""

from collections.abc import Mapping, Sequence

import numpy as np

from ....base.arrays import FloatArray
from ..experiment import Chart, Claim, Experiment, Findings, Line, verdict_of
from ..trial import Numbers, Trial, trial
from .machine import CHANGED_NS, CONSTANTS, POLICIES

_SCENES = ("ogres", "ogres-trees")
_PATHS = ("drive", "walk")
_SEEDS, _SECONDS = 5, 6.0
_CALLS_US = (0.0, 3.0, 10.0, 30.0, 100.0, 300.0)
_CHANGED_NS = (5.0, 20.0, 50.0, 100.0)
_USUAL_US = 10.0
_PAYS = 1.05  # a frame rate so many times as high is worth speaking of


def _trials(reduced: bool) -> Sequence[Trial]:
    scenes = _SCENES[:1] if reduced else _SCENES
    runs: list[Trial] = []
    for scene in scenes:
        for path in _PATHS:
            for seed in range(1 if reduced else _SEEDS):
                for policy in POLICIES:
                    for whole in (False, True):
                        if policy == "own slots" and (reduced or not whole):
                            continue
                        call_us = _USUAL_US if whole else 0.0
                        runs.append(
                            _trial(scene, path, seed, policy, call_us, CHANGED_NS, whole, reduced)
                        )
    # The sweeps, on one seed: how much the answer depends on what is assumed.
    for path in _PATHS:
        for policy in ("manager", "exact"):
            calls = (0.0, 300.0) if reduced else _CALLS_US
            runs += [
                _trial("ogres", path, 0, policy, call_us, CHANGED_NS, True, reduced)
                for call_us in calls
            ]
            runs += [
                _trial("ogres", path, 0, policy, 0.0, changed_ns, False, reduced)
                for changed_ns in ((100.0,) if reduced else _CHANGED_NS)
            ]
    return list(dict.fromkeys(runs))


def _trial(
    scene: str,
    path: str,
    seed: int,
    policy: str,
    call_us: float,
    changed_ns: float,
    whole: bool,
    reduced: bool,
) -> Trial:
    return trial(
        _key(scene, path, seed, policy, call_us, changed_ns, whole),
        "gumbau.frame_rates:measure",
        {
            "scene": scene,
            "path": path,
            "seed": seed,
            "seconds": 2.0 if reduced else _SECONDS,
            "policy": POLICIES[policy],
            "call_us": call_us,
            "changed_ns": changed_ns,
            "whole": whole,
        },
    )


def _key(
    scene: str, path: str, seed: int, policy: str, call_us: float, changed_ns: float, whole: bool
) -> str:
    how = f"whole set, {call_us:g} µs a call" if whole else "in place"
    return f"{scene}, {path}, seed {seed}, {policy}, {how}, {changed_ns:g} ns"


def _judge(numbers: Mapping[str, Numbers], reduced: bool) -> Findings:
    scenes = _SCENES[:1] if reduced else _SCENES
    seeds = range(1 if reduced else _SEEDS)

    def bins(scene: str, path: str, policy: str, *, whole: bool, column: str = "fps") -> FloatArray:
        call_us = _USUAL_US if whole else 0.0
        return np.concatenate(
            [
                numbers[_key(scene, path, seed, policy, call_us, CHANGED_NS, whole)][column]
                for seed in seeds
            ]
        )

    claims: list[Claim] = []
    for scene in scenes:
        for path in _PATHS:
            for whole in (False, True):
                gain = bins(scene, path, "manager", whole=whole) / bins(
                    scene, path, "exact", whole=whole
                )
                claims.append(_gain_claim(scene, path, gain, whole=whole))
            claims.append(
                _triangles_claim(
                    scene,
                    path,
                    bins(scene, path, "manager", whole=True, column="triangles"),
                    bins(scene, path, "exact", whole=True, column="triangles"),
                )
            )
    curves = {
        path: [
            _median_gain(numbers, path, call_us, CHANGED_NS, whole=True)
            for call_us in ((0.0, 300.0) if reduced else _CALLS_US)
        ]
        for path in _PATHS
    }
    calls = (0.0, 300.0) if reduced else _CALLS_US
    charts = (_curve(calls, curves), _figure(numbers))
    notes = [_where_it_pays(calls, curves), _what_changes(numbers, seeds)]
    changed = (100.0,) if reduced else _CHANGED_NS
    told = "; ".join(
        f"{path} "
        + ", ".join(
            f"{_median_gain(numbers, path, 0.0, ns, whole=False):.3f} at {ns:g} ns"
            for ns in changed
        )
        for path in _PATHS
    )
    notes.append(f"In place, the median gain over the cost of a changed triangle: {told}.")
    if not reduced:
        own = "; ".join(
            f"{scene}, {path} {np.median(manager / own):.3f}"
            for scene in _SCENES
            for path in _PATHS
            for manager in (bins(scene, path, "manager", whole=True),)
            for own in (bins(scene, path, "own slots", whole=True),)
        )
        notes.append(
            "What of it sharing adds to having slots at all, each object keeping its own sets "
            f"(median gain over that, {_USUAL_US:g} µs a call): {own}."
        )
    return Findings(tuple(claims), charts, tuple(notes))


def _gain_claim(scene: str, path: str, gain: FloatArray, *, whole: bool) -> Claim:
    how = f"whole sets uploaded, {_USUAL_US:g} µs a call" if whole else "changed in place"
    median = float(np.median(gain))
    throughout = float((gain > 1.0).mean())
    return Claim(
        f"the frame rate is higher with the manager, throughout; `{scene}`, {path}, {how}",
        "higher throughout (figure; no numbers in the text)",
        f"times as high: {gain.min():.2f}, median {median:.3f}, {gain.max():.2f}; higher in "
        f"{100 * throughout:.0f} % of seconds",
        f"every second, median {_PAYS:g}",
        verdict_of(
            throughout == 1.0 and median >= _PAYS,
            f"the median gain is {median:.3f}: levels really change too little to be the "
            "bottleneck at this cost",
            direction=throughout == 1.0 or median >= _PAYS,
        ),
    )


def _triangles_claim(scene: str, path: str, manager: FloatArray, exact: FloatArray) -> Claim:
    mean = 100.0 * float(manager.mean() / exact.mean() - 1.0)
    worst = 100.0 * float(np.abs(manager / exact - 1.0).max())
    return Claim(
        f"as many triangles are drawn with the manager; `{scene}`, {path}",
        "nearly the same (figure)",
        f"{mean:+.2f} % on the mean, {worst:.1f} % in the worst second",
        "3 % on the mean, 5 % in every second",
        verdict_of(
            abs(mean) <= 3.0 and worst <= 5.0,
            f"{mean:+.1f} % on the mean",
            direction=abs(mean) <= 3.0,
        ),
    )


def _median_gain(
    numbers: Mapping[str, Numbers], path: str, call_us: float, changed_ns: float, *, whole: bool
) -> float:
    fps = {
        policy: np.array(numbers[_key("ogres", path, 0, policy, call_us, changed_ns, whole)]["fps"])
        for policy in ("manager", "exact")
    }
    return float(np.median(fps["manager"] / fps["exact"]))


def _where_it_pays(calls: Sequence[float], curves: Mapping[str, Sequence[float]]) -> str:
    parts: list[str] = []
    for path, gain in curves.items():
        if max(gain) < _PAYS:
            parts.append(f"on {path} nowhere up to {calls[-1]:g} µs (at most {max(gain):.2f})")
        elif gain[0] >= _PAYS:
            parts.append(f"on {path} from no call cost on ({gain[0]:.2f} to {gain[-1]:.2f})")
        else:
            from_us = float(np.interp(_PAYS, np.maximum.accumulate(gain), calls))
            parts.append(
                f"on {path} from about {from_us:.0f} µs on, {gain[-1]:.2f} at {calls[-1]:g} µs"
            )
    return (
        f"Where the manager pays (a gain of {_PAYS:g} or more), over what the call of an upload "
        f"costs, sets being sent whole: {'; '.join(parts)}.  Where it costs less, the sets that "
        "really change do not make the processor the bottleneck, and there is nothing to win."
    )


def _what_changes(numbers: Mapping[str, Numbers], seeds: Sequence[int]) -> str:
    parts: list[str] = []
    for path in _PATHS:
        for policy in ("exact", "manager"):
            runs = [
                numbers[_key("ogres", path, seed, policy, _USUAL_US, CHANGED_NS, True)]
                for seed in seeds
            ]

            def mean(column: str, runs: Sequence[Numbers] = runs) -> float:
                return float(np.mean([run[column] for run in runs]))

            parts.append(
                f"{path}, {policy}: {mean('levels_extracted'):.2f} sets, "
                f"{mean('triangles_changed'):.0f} triangles changed, "
                f"{1e-3 * mean('bytes_uploaded'):.1f} kB, {mean('levels_borrowed'):.2f} borrowed, "
                f"CPU {mean('cpu_ms'):.2f} ms, GPU {mean('gpu_ms'):.2f} ms"
            )
    return f"What a frame of `ogres` does, on the mean: {'; '.join(parts)}."


def _curve(calls: Sequence[float], curves: Mapping[str, Sequence[float]]) -> Chart:
    return Chart(
        name="gain",
        caption="What the manager gains depends on what an upload costs.",
        x="call of an upload, µs",
        y="frame rate with the manager over that without",
        lines=tuple(Line(path, calls, gain) for path, gain in curves.items()),
    )


def _figure(numbers: Mapping[str, Numbers]) -> Chart:
    lines = [
        Line(f"{path}, {policy}", np.arange(len(fps)).tolist(), fps)
        for path in _PATHS
        for policy in ("manager", "exact")
        for fps in (numbers[_key("ogres", path, 0, policy, _USUAL_US, CHANGED_NS, True)]["fps"],)
    ]
    return Chart(
        name="frame-rate",
        caption=f"Frame rates along the path, {_USUAL_US:g} µs for the call of an upload.",
        x="path, s",
        y="frames a second",
        lines=tuple(lines),
    )


FIG6 = Experiment(
    id="gumbau/fig6",
    title="frame rates with and without the manager",
    setting=f"`ogres` and `ogres-trees`, paths `drive` and `walk` of {_SECONDS:g} s, {_SEEDS} "
    "seeds; with the manager, and every object at its own collapse step; compared by the second "
    "of the path.  Changes are charged in place (LodStrips), or by uploading whole sets.",
    constants=CONSTANTS,
    trials=_trials,
    judge=_judge,
)
