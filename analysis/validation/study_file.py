"""Which paths through which scenes a validation goes along: a TOML file of cases, or one case.

.. code:: toml

    [[case]]
    scene = "market"
    trace = "drive"
    budget_ms = 5.0
    seconds = "0:10"
"""

from dataclasses import dataclass, fields, replace
from pathlib import Path

from ...base.errors import InputError, is_file
from ...base.files.strict_toml import read_toml

_LARGEST_BYTES = 1_000_000


@dataclass(frozen=True, slots=True)
class CaseSpec:
    """One path through one scene, by name; None for what the command line says of all.

    Attributes
    ----------
    scene : a bundled scene, or a scene file, beside the study's file too
    trace : ``tour``, a kind of movement, or a file
    budget_ms : of a frame
    seconds : stretch of the path, ``A:B``
    place : how the path of a file is put into the scene
    fovy_deg : vertical field of view
    policies : as on the command line
    frames_in_flight : drawn so deep, to measure lag; 0 waits for each drawing
    threads : of llvmpipe, beside the caller's
    """

    scene: str
    trace: str
    budget_ms: float | None = None
    seconds: str | None = None
    place: str | None = None
    fovy_deg: float | None = None
    policies: tuple[str, ...] | None = None
    frames_in_flight: int | None = None
    threads: int | None = None

    def or_else(self, default: "CaseSpec") -> "CaseSpec":
        """Return the case with what it leaves open taken from another."""
        names = [item.name for item in fields(self)]
        missing = {name: getattr(default, name) for name in names if getattr(self, name) is None}
        return replace(self, **missing)


def read_cases(path: Path) -> list[CaseSpec]:
    """Return the cases of a file; raises `InputError` with the line of what is wrong."""
    document = read_toml(path, _LARGEST_BYTES, "give the cases of a validation")
    table = document.table(document.content, ["case"], "")
    cases = table.get("case", [])
    if not isinstance(cases, list) or not cases:
        raise InputError("expected one [[case]] or more, got none; add one", path=path)
    found = [
        document.record(case, CaseSpec, f"case.{at}")
        for at, case in enumerate(cases)  # pyright: ignore[reportUnknownVariableType, reportUnknownArgumentType]
    ]
    for at, case in enumerate(found):
        if case.policies is not None and not case.policies:
            message = "policies: expected one or more, got none; leave the key out for the default"
            document.fail(f"case.{at}.policies", message)
    return [_beside(case, path.parent) for case in found]


def _beside(case: CaseSpec, folder: Path) -> CaseSpec:
    """Return a case whose files are looked for beside the study's file first."""
    scene, trace = folder / case.scene, folder / case.trace
    return replace(
        case,
        scene=str(scene) if is_file(scene) else case.scene,
        trace=str(trace) if is_file(trace) else case.trace,
    )
