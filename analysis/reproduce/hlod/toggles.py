"""R6: how often nodes are switched (thesis, section 6.5)."""

from collections.abc import Sequence

from ..experiment import (
    IN_DIRECTION,
    REPRODUCED,
    Chart,
    Claim,
    Experiment,
    Findings,
    Line,
    not_reproduced,
    verdict_of,
)
from ..trial import Numbers, Trial, trial
from .runs import Runs, frames, key, of_seeds, runs
from .setting import CONSTANTS, SHARED, THESIS, USED_MS, mean, spread

_WALK, _DRIVE = 3.0 / 400.0, 1.0 / 11.0
_LOW, _HIGH = 0.0015, 0.022
"""Poisson's 95 % interval of 3 toggles in 400 frames, a frame."""

_RATIO = (6.0, 20.0)
_SPEEDS_M_S = {"walk": 1.4, "drive": 14.0}
_DISKS_MB_S = (40.0, 100.0, 400.0, 2000.0)
_DISK_MB_S = 100.0  # of the profile
_OTHER_PATHS = (1, 2, 3, 4)
_OPTIONS = {
    "share_rate=0.001": "the roots' share rises a third as fast",
    "switch=4.5,limit=13.5": "counters three times as wide",
    "fore=0": "no foreshortening",
    "lead_s=0": "no lead",
}


def _sweep(reduced: bool) -> list[Trial]:
    if reduced:
        return []
    base = {"seed": 0, "frames": frames(reduced)}
    found: list[Trial] = []
    for path in _SPEEDS_M_S:
        arguments = {**base, "policy": THESIS, "path": path}
        found += [
            trial(
                f"disk {disk:g}/{path}",
                "hlod.setting:measure",
                {**arguments, "disk_bytes_per_s": disk * 1e6},
            )
            for disk in _DISKS_MB_S
            if disk != _DISK_MB_S
        ]
        found += [
            trial(f"path {seed}/{path}", "hlod.setting:measure", {**arguments, "path_seed": seed})
            for seed in _OTHER_PATHS
        ]
        found += [
            trial(
                f"{option}/{path}",
                "hlod.setting:measure",
                {**arguments, "policy": f"{THESIS},{option}"},
            )
            for option in _OPTIONS
        ]
    return found


def _trials(reduced: bool) -> Sequence[Trial]:
    own = [
        one
        for path in _SPEEDS_M_S
        for policy in (THESIS, SHARED)
        for one in runs(policy, path, reduced=reduced)
    ]
    return own + _sweep(reduced)


def _judge(numbers: Runs, reduced: bool) -> Findings:
    claims: list[Claim] = []
    for policy, label in ((THESIS, "thesis' own"), (SHARED, "unused slices shared")):
        claims += [
            _walk(numbers, policy, label, reduced=reduced),
            _drive(numbers, policy, label, reduced=reduced),
        ]
    claims.append(_reversals(numbers, reduced=reduced))
    if reduced:
        return Findings(tuple(claims))
    return Findings(tuple(claims), (_chart(numbers),), _notes(numbers, reduced=reduced))


def _walk(numbers: Runs, policy: str, label: str, *, reduced: bool) -> Claim:
    mine = of_seeds(numbers, policy, "walk", reduced=reduced)
    toggles, used_ms = mean(mine, "toggles"), mean(mine, "ms_mean")
    within = _LOW <= toggles <= _HIGH
    used = used_ms >= USED_MS
    verdict = REPRODUCED
    if not used:
        verdict = not_reproduced(f"{used_ms:.1f} ms are used, less than 80 % of 30 ms")
    elif not within:
        verdict = not_reproduced(
            f"{toggles / _WALK:.1f} times the print; its path and its walls' costs are not known"
        )
    return Claim(
        f"toggles a frame, walk, {label}",
        "0.0075 (3 in 400 frames)",
        f"{spread(mine, 'toggles', 4)}, {spread(mine, 'toggles_per_m', 2)} a metre, "
        f"{used_ms:.1f} ms used",
        "0.0015 to 0.022 (Poisson) at 24 ms or more",
        verdict,
    )


def _drive(numbers: Runs, policy: str, label: str, *, reduced: bool) -> Claim:
    walk, drive = (of_seeds(numbers, policy, path, reduced=reduced) for path in ("walk", "drive"))
    toggles, used_ms = mean(drive, "toggles"), mean(drive, "ms_mean")
    ratio = toggles / max(mean(walk, "toggles"), 1e-9)
    within = _RATIO[0] <= ratio <= _RATIO[1] and 0.5 * _DRIVE <= toggles <= 2.0 * _DRIVE
    verdict = verdict_of(
        within and used_ms >= USED_MS,
        f"{ratio:.1f} times the walk's at {used_ms:.1f} ms",
        direction=ratio > 2.0,
    )
    return Claim(
        f"toggles a frame, drive at ten times the speed, {label}",
        "0.09 (one in 11 frames), 12 times the walk's",
        f"{spread(drive, 'toggles', 4)}, {ratio:.1f} times the walk's, "
        f"{spread(drive, 'toggles_per_m', 2)} a metre, {used_ms:.1f} ms used",
        "0.045 to 0.18, 6 to 20 times, at 24 ms or more",
        verdict,
    )


def _reversals(numbers: Runs, *, reduced: bool) -> Claim:
    parts: list[str] = []
    worst = 0.0
    for path in _SPEEDS_M_S:
        mine = of_seeds(numbers, THESIS, path, reduced=reduced)
        share = mean(mine, "reversals") / max(mean(mine, "toggles"), 1e-9)
        worst = max(worst, share)
        parts.append(f"{path} {100.0 * share:.0f} %")
    return Claim(
        "toggles that are undone within half a second",
        "'we do not get successive up and down toggles'",
        ", ".join(parts),
        "at most 10 %",
        REPRODUCED
        if worst <= 0.1
        else IN_DIRECTION
        if worst <= 0.3
        else not_reproduced(f"{100.0 * worst:.0f} % of toggles are undone"),
    )


def _chart(numbers: Runs) -> Chart:
    lines = [
        Line(path, _DISKS_MB_S, [numbers[_disk(disk, path)]["toggles"] for disk in _DISKS_MB_S])
        for path in _SPEEDS_M_S
    ]
    ends = (_DISKS_MB_S[0], _DISKS_MB_S[-1])
    lines += [
        Line("printed, walk", ends, (_WALK, _WALK), True),
        Line("printed, drive", ends, (_DRIVE, _DRIVE), True),
    ]
    return Chart(
        name="disk",
        caption="How fast nodes are read decides how often they are switched, most of all in the "
        "drive.",
        x="disk, MB/s of decoded nodes",
        y="toggles a frame",
        lines=tuple(lines),
        log_x=True,
        log_y=True,
    )


def _disk(disk_mb_s: float, path: str) -> str:
    """Return the key of the first seed's run with a disk."""
    return key(THESIS, path, 0) if disk_mb_s == _DISK_MB_S else f"disk {disk_mb_s:g}/{path}"


def _notes(numbers: Runs, *, reduced: bool) -> tuple[str, ...]:
    def told(walk: Numbers, drive: Numbers) -> str:
        return (
            f"{walk['toggles']:.4f} and {drive['toggles']:.4f} at {walk['ms_mean']:.1f} and "
            f"{drive['ms_mean']:.1f} ms"
        )

    def of(name: str) -> str:
        return told(*(numbers[f"{name}/{path}"] for path in _SPEEDS_M_S))

    disks = "; ".join(
        f"{disk:g} MB/s {told(*(numbers[_disk(disk, path)] for path in _SPEEDS_M_S))}"
        for disk in _DISKS_MB_S
    )
    paths = "; ".join(of(f"path {seed}") for seed in _OTHER_PATHS)
    options = "; ".join(f"{what} {of(option)}" for option, what in _OPTIONS.items())
    first = of_seeds(numbers, THESIS, "drive", reduced=reduced)
    return (
        f"Toggles of walk and drive by the disk, seed 0: {disks}.",
        f"On four other ways along the same streets, at 0.7 to 1 of the speeds: {paths}.",
        f"By other constants: {options}.",
        (
            "The windows begin where the roots' share has changed by less than 5 % in 100 frames, "
            f"in the drive at frames {', '.join(str(one['first']) for one in first)}; 1000 is the "
            "last, where it never settles."
        ),
    )


TOGGLES = Experiment(
    id="hlod/toggles",
    title="flicker (R6, figure 6.6)",
    setting="`city`, walk at 1.4 m/s and drive at 14 m/s along its streets; 400 frames from where "
    "the roots' share has settled; 5 seeds of noise.",
    constants=CONSTANTS,
    trials=_trials,
    judge=_judge,
)
