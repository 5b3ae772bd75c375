"""What has to be the same on two machines for results to be the same bytes."""

import platform
import sys
from dataclasses import dataclass, fields
from importlib.metadata import version

from ...code_hash import code_hash


@dataclass(frozen=True, slots=True)
class Versions:
    """What numbers depend on.

    Attributes
    ----------
    lodbench : hash of the sources that decide what a run results in
    python : major and minor version
    numpy, scipy, casadi : versions
    machine : kind of processor
    """

    lodbench: str
    python: str
    numpy: str
    scipy: str
    casadi: str
    machine: str


def versions_here() -> Versions:
    """Return those of this process."""
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    return Versions(
        code_hash(),
        python,
        version("numpy"),
        version("scipy"),
        version("casadi"),
        platform.machine(),
    )


def describe_difference(wanted: Versions, got: Versions) -> str:
    """Return in words how what was got differs from what was wanted; empty if it does not."""
    return ", ".join(
        f"{field.name} {getattr(got, field.name)[:12]} in place of "
        f"{getattr(wanted, field.name)[:12]}"
        for field in fields(Versions)
        if getattr(got, field.name) != getattr(wanted, field.name)
    )
