"""Trace and corner plots of a chain; needs the extra ``fit-plots``."""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ...base.errors import InputError
from ...base.files.whole_file import whole_file
from .sampling.sampler import Chain

_MOST_POINTS = 20_000


def require_plots() -> None:
    """Raise InputError unless matplotlib and corner are installed."""
    missing = [name for name in ("matplotlib", "corner") if find_spec(name) is None]
    if missing:
        raise InputError(
            f"--plots: expected matplotlib and corner, got no {' and no '.join(missing)}; "
            "pip install lodbench[fit-plots]"
        )


def write_plots(chain: Chain, folder: Path) -> tuple[Path, ...]:
    """Write ``trace.png`` and ``corner.png`` into a folder and return their paths.

    Raises `InputError` if the extra is not installed.
    """
    require_plots()
    folder.mkdir(parents=True, exist_ok=True)
    paths = folder / "trace.png", folder / "corner.png"
    for path, figure in zip(paths, (_trace(chain), _corner(chain)), strict=True):
        with whole_file(path) as partial:
            figure.savefig(partial, format="png", dpi=120, metadata={"Software": None})
    return paths


def _trace(chain: Chain) -> Any:
    """Return a figure of every walker over the steps, a row for each parameter."""
    figure = _figure(8.0, 1.4 * len(chain.names) + 0.6)
    axes: list[Any] = list(figure.subplots(len(chain.names), 1, sharex=True))
    for place, (axis, name) in enumerate(zip(axes, chain.names, strict=True)):
        axis.plot(chain.samples[:, :, place], color="black", alpha=0.15, linewidth=0.4)
        axis.set_ylabel(name, rotation=0, horizontalalignment="right")
    axes[-1].set_xlabel("step after burn-in")
    figure.set_layout_engine("constrained")
    return figure


def _corner(chain: Chain) -> Any:
    """Return a figure of all pairs of parameters."""
    figure = _figure(2.0 * len(chain.names), 2.0 * len(chain.names))
    corner: Any = import_module("corner")
    points = chain.thinned(_MOST_POINTS)
    corner.corner(points, labels=list(chain.names), fig=figure, quantiles=(0.05, 0.5, 0.95))
    return figure


def _figure(width: float, height: float) -> Any:
    """Return an empty figure of so many inches; the extra is imported by name, being optional."""
    module: Any = import_module("matplotlib.figure")
    return module.Figure(figsize=(width, height))
