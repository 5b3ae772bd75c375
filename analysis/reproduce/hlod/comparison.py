"""R7: flicker beside what the thesis compares with, at equal use of time (sections 2.3, 5)."""

from collections.abc import Sequence

from ...study.engine.task import Beat
from ..experiment import Chart, Claim, Constant, Experiment, Findings, Line, verdict_of
from ..trial import Numbers, Trial, trial
from .runs import Runs
from .setting import (
    CONSTANTS,
    SHARED,
    TARGET_MS,
    THESIS,
    USED_MS,
    replay_city,
    settled_window,
    spread,
    summarise,
)

_POLICIES = {
    THESIS: "thesis' own",
    SHARED: "unused slices shared",
    "funkhouser:adapt=0.2": "Funkhouser",
    "maciel": "Maciel",
    "mason-blake": "Mason-Blake",
    "erikson": "Erikson",
}
_PATHS = ("walk", "drive")
_USED = 0.03  # relative
_TRIES = 6
_FAST_DISK = 2e9


def measure(*, policy: str, path: str, seed: int, frames: int, beat: Beat) -> Numbers:
    """Replay with the budget at which 24 ms are used, and return what the window comes to.

    The budget that the policy is told is changed in proportion until the mean is within 3 %; what
    comes nearest counts.
    """
    budget_ms, best = TARGET_MS, dict[str, float]()
    for _ in range(_TRIES):
        log, share_ms = replay_city(
            policy,
            path,
            seed=seed,
            frames=frames,
            budget_ms=budget_ms,
            disk_bytes_per_s=_FAST_DISK,
            beat=beat,
        )
        found = summarise(log, settled_window(share_ms, len(log)), share_ms)
        found = {name: value for name, value in found.items() if name not in ("gpu_ms", "roots")}
        found["budget_ms"] = budget_ms
        if not best or abs(found["ms_mean"] - USED_MS) < abs(best["ms_mean"] - USED_MS):
            best = found
        if abs(found["ms_mean"] / USED_MS - 1.0) <= _USED:
            break
        budget_ms *= min(max(USED_MS / found["ms_mean"], 0.5), 2.0)
    return best


def _seeds(reduced: bool) -> range:
    return range(1) if reduced else range(5)


def _policies(reduced: bool) -> list[str]:
    return [SHARED, "funkhouser:adapt=0.2", "erikson"] if reduced else list(_POLICIES)


def _trials(reduced: bool) -> Sequence[Trial]:
    frames = 400 if reduced else 800
    return [
        trial(
            f"{policy}/{path}/{seed}",
            "hlod.comparison:measure",
            {"policy": policy, "path": path, "seed": seed, "frames": frames},
        )
        for policy in _policies(reduced)
        for path in (_PATHS[:1] if reduced else _PATHS)
        for seed in _seeds(reduced)
    ]


def _of(numbers: Runs, policy: str, path: str, reduced: bool) -> list[Numbers]:
    return [numbers[f"{policy}/{path}/{seed}"] for seed in _seeds(reduced)]


def _means(numbers: Runs, policy: str, path: str, name: str, reduced: bool) -> float:
    found = _of(numbers, policy, path, reduced)
    return sum(one[name] for one in found) / len(found)


def _judge(numbers: Runs, reduced: bool) -> Findings:
    claims: list[Claim] = []
    for path in _PATHS[:1] if reduced else _PATHS:
        claims += _claims(numbers, path, reduced)
    if reduced:
        return Findings(tuple(claims))
    lines = [
        Line(
            label,
            [_means(numbers, policy, path, "popping_px", reduced) for path in _PATHS],
            [_means(numbers, policy, path, "toggles", reduced) for path in _PATHS],
        )
        for policy, label in _POLICIES.items()
    ]
    chart = Chart(
        name="flicker",
        caption="Counted in toggles Funkhouser's few large switches look calm; seen on the screen "
        "they are the worst.  Each line runs from the walk to the drive.",
        x="popping, px a frame",
        y="toggles a frame",
        lines=tuple(lines),
        log_x=True,
        log_y=True,
    )
    return Findings(tuple(claims), (chart,), _notes(numbers, reduced))


def _claims(numbers: Runs, path: str, reduced: bool) -> list[Claim]:
    mine = SHARED
    found: list[Claim] = []
    rivals: dict[str, str] = {"funkhouser:adapt=0.2": "popping_px", "erikson": "toggles"}
    if not reduced:
        rivals["maciel"] = "toggles"
    for rival, name in rivals.items():
        own, other = (_means(numbers, policy, path, name, reduced) for policy in (mine, rival))
        what = "popping, px a frame" if name == "popping_px" else "toggles a frame"
        digits = 4
        found.append(
            Claim(
                f"{path}: less than {_POLICIES[rival]} in {what}",
                "not printed; section 5 argues so"
                if name == "popping_px"
                else "not printed; sections 2.3 and 4.2 argue so",
                f"{spread(_of(numbers, mine, path, reduced), name, digits)} against "
                f"{spread(_of(numbers, rival, path, reduced), name, digits)}, at "
                f"{_means(numbers, mine, path, 'ms_mean', reduced):.1f} and "
                f"{_means(numbers, rival, path, 'ms_mean', reduced):.1f} ms",
                "",
                verdict_of(
                    own < other, f"{own:.4f} is not less than {other:.4f} at equal use of time"
                ),
            )
        )
    return found


def _notes(numbers: Runs, reduced: bool) -> tuple[str, ...]:
    notes: list[str] = []
    for path in _PATHS:
        rows = [
            f"{label}: toggles {_means(numbers, policy, path, 'toggles', reduced):.4f}, reversals "
            f"{_means(numbers, policy, path, 'reversals', reduced):.4f}, popping "
            f"{_means(numbers, policy, path, 'popping_px', reduced):.4f} px, "
            f"{_means(numbers, policy, path, 'ms_mean', reduced):.1f} ± "
            f"{_means(numbers, policy, path, 'ms_sd', reduced):.1f} ms"
            for policy, label in _POLICIES.items()
        ]
        notes.append(f"A frame of the {path}: {'; '.join(rows)}.")
    notes.append(
        "Funkhouser, Maciel and Mason-Blake know the machine's exact costs here, which no such "
        "system has; the thesis' policy and Erikson's learn them from frames."
    )
    return tuple(notes)


COMPARISON = Experiment(
    id="hlod/comparison",
    title="flicker beside other policies at equal use of the budget (R7)",
    setting="`city`, walk and drive with a disk so fast that all is in memory at once; every "
    "policy is told the budget at which its frames take 24 ms on average, to 3 %; 5 seeds.",
    constants={**CONSTANTS, "disk": Constant("2 GB/s", "assumed", "the others stream nothing")},
    trials=_trials,
    judge=_judge,
)
