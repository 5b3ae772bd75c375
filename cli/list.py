"""`lodbench list`: what is known by name."""

import inspect
import json
import re
from collections.abc import Callable, Iterator
from typing import Annotated, Any, Literal, get_args

from rich.console import Console
from rich.padding import Padding
from rich.table import Column, Table
from rich.text import Text
from typer import Argument, Typer

from .shared.options import AsJson

Item = dict[str, Any]
Subject = Literal["policies", "scenes", "traces", "hardware", "metrics", "formats"]

_ONLY_IN_JSON = ("group", "source")  # of metrics, which docs/metrics.md has in full
_UNITS = {"m_s": "m/s", "deg_s": "deg/s", "m": "m"}


app = Typer(add_completion=False)


@app.command("list")
def list_known(
    kind: Annotated[Subject, Argument(metavar="KIND", help=f"{', '.join(get_args(Subject))}.")],
    *,
    as_json: AsJson = False,
) -> None:
    """List policies, scenes, traces, hardware, metrics or formats of files."""
    items = known(kind)
    if as_json:
        print(json.dumps({"schema": "lodbench.list/1", "kind": kind, "items": items}))
    elif kind in {"policies", "hardware"}:
        _print_sections(items)
    else:
        _print_table(items)


def known(kind: Subject) -> list[Item]:
    """Return a record of everything of a kind, all with the same keys."""
    return list(_KNOWN[kind]())


def _policies() -> Iterator[Item]:
    from dataclasses import asdict

    from ..policies.knob import knob_of
    from ..policies.protocol import claims_of
    from ..policies.registry import REGISTERED, parameters, parse_policy

    for name in sorted(REGISTERED):
        spec = parse_policy(name)
        cls, claims, knob = spec.cls, claims_of(spec.make()), knob_of(spec)
        parts = _headings(inspect.getdoc(cls) or "")
        comments = _default_comments(inspect.getsource(cls))
        capabilities: dict[str, bool] = asdict(cls.capabilities)
        yield {
            "name": name,
            "idea": parts["Idea"],
            "uses": parts["Uses"],
            "parameters": [
                {"name": p.name, "default": p.default, "comment": comments.get(p.name, "")}
                for p in parameters(cls)
            ],
            "knob": None if knob is None else asdict(knob),
            "no_knob": parts.get("Knob", ""),
            "cost_per_frame": parts["Cost per frame"],
            "capabilities": [key for key, has in capabilities.items() if has and key != "future"],
            "oracle": capabilities["future"],
            "claims": [
                *(key for key, holds in asdict(claims).items() if holds is True),
                *_rest(claims.settles_frames),
            ],
            "reference": parts["Reference"],
        }


def _rest(frames: int | None) -> list[str]:
    """Say after how many frames a policy rests, if it claims to."""
    if frames is None:
        return []
    return [f"rests after {frames} frame{'s' * (frames != 1)}" if frames else "rests at once"]


def _headings(docstring: str) -> dict[str, str]:
    """Split a policy's docstring at ``Idea:``, ``Uses:`` and so on; a part may have paragraphs."""
    heading = re.compile(r"^(Idea|Uses|Parameters|Knob|Cost per frame|Reference):", re.MULTILINE)
    parts = heading.split(docstring)
    texts = (" ".join(part.replace("``", "`").split()) for part in parts[2::2])
    return dict(zip(parts[1::2], texts, strict=True))


def describe_knob(item: Item) -> str:
    """Say what trades a policy's picture for time and in which range, or why nothing does."""
    knob: Item | None = item["knob"]
    if knob is None:
        return str(item["no_knob"])
    low, high = knob["low"], knob["high"]
    return f"{knob['name']}, {low:g} to {high:g} ({knob['scale']}), finer when {knob['finer']}"


def _default_comments(source: str) -> dict[str, str]:
    """Return the comment behind each default of a dataclass."""
    return dict(re.findall(r"^    (\w+): .+ = .+?  # (.+)$", source, flags=re.MULTILINE))


def _scenes() -> Iterator[Item]:
    from ..models.scenes.scene_registry import SCENES

    for name in SCENES:
        yield {"name": name, "about": SCENES.find(name).about}


def _traces() -> Iterator[Item]:
    from ..analysis.study.inputs import BUNDLED_TRACE
    from ..traces.cameras.generators.generate import KINDS
    from ..traces.cameras.generators.tour import EYE_M, TURN_DEG_S

    # The tour crosses any scene in the same time.
    tour = {"speed_m_s": None, "turn_deg_s": TURN_DEG_S, "height_m": EYE_M}
    yield {"name": BUNDLED_TRACE, **tour}
    for name, kind in KINDS.items():
        yield {
            "name": name,
            "speed_m_s": kind.limits.speed_m_s,
            "turn_deg_s": kind.limits.turn_deg_s,
            "height_m": kind.height_m,
        }


def _hardware() -> Iterator[Item]:
    from ..models.machine.profile_catalog import list_hardware, load_hardware

    for name in list_hardware():
        profile = load_hardware(name)
        display = profile.display
        yield {
            "name": name,
            "assumed": profile.provenance.assumed,
            "display": f"{display.mode} {display.width_px}x{display.height_px}",
            "frames_in_flight": profile.frames_in_flight,
            "pacing": display.pacing,
            "renderer": profile.provenance.renderer,
            "date": profile.provenance.date,
            "source": profile.provenance.source,
        }


def _metrics() -> Iterator[Item]:
    from dataclasses import asdict

    from ..analysis.metrics.metric_registry import METRICS

    for metric in METRICS:
        yield {key: value for key, value in asdict(metric).items() if key != "function"}


def _formats() -> Iterator[Item]:
    from ..traces.cameras.read_trace import FORMATS
    from ..traces.logs.read_log import LOG_FORMATS

    for name in FORMATS:
        yield {"name": name, "of": "camera traces", "about": FORMATS.find(name).what}
    for name in LOG_FORMATS:
        yield {"name": name, "of": "render logs", "about": LOG_FORMATS.find(name).what}


_KNOWN: dict[Subject, Callable[[], Iterator[Item]]] = {
    "policies": _policies,
    "scenes": _scenes,
    "traces": _traces,
    "hardware": _hardware,
    "metrics": _metrics,
    "formats": _formats,
}


def _print_sections(items: list[Item]) -> None:
    """Print things that are described by sentences, one below the other."""
    console = Console(highlight=False)
    for item in items:
        table = Table(box=None, show_header=False, padding=(0, 1))
        title, *rows = _rows(item)
        for label, text in rows:
            table.add_row(Text(label), Text(text))
        console.print(Text(title[1], "bold"))
        console.print(Padding(table, (0, 0, 1, 1)))


def _rows(item: Item) -> Iterator[tuple[str, str]]:
    for key, value in item.items():
        if key == "parameters":
            yield from ((f"{p['name']}={p['default']}", p["comment"]) for p in value)
        elif key == "knob":
            yield "knob", describe_knob(item)
        elif key != "no_knob" and (text := _show(value)):
            yield _label(key), text


def _print_table(items: list[Item]) -> None:
    """Print things that are described by a few words and numbers, one a line."""
    first, *others = (key for key in items[0] if key not in _ONLY_IN_JSON)
    table = Table(Column(first, no_wrap=True), *map(_label, others))
    for item in items:
        table.add_row(*(Text(_show(item[key])) for key in (first, *others)))
    Console(highlight=False).print(table)


def _label(key: str) -> str:
    """Write ``speed_m_s`` as ``speed, m/s`` and ``cost_per_frame`` as ``cost per frame``."""
    for suffix, unit in _UNITS.items():
        if key.endswith(f"_{suffix}"):
            return f"{key.removesuffix(f'_{suffix}')}, {unit}"
    return key.replace("_", " ")


def _show(value: float | str | list[str] | None) -> str:
    match value:
        case None:
            return "by scene"
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:g}"
        case list():
            return ", ".join(value)
        case _:
            return str(value)
