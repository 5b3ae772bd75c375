"""`lodbench view`: look at what policies draw along the first path of a comparison."""

import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option

from ..base.errors import InputError
from .shared.options import AsJson
from .shared.terminal import open_named_scene, print_result

if TYPE_CHECKING:  # numpy is loaded by the command that needs it
    from ..analysis.study.comparison import Comparison
    from ..analysis.view.view_server import PageServer
    from ..models.meshes.geometry import Geometry

Folder = Annotated[Path, Argument(metavar="DIR", help="A folder that `compare --out` wrote.")]
Policies = Annotated[
    list[str] | None,
    Option(help="A policy as the report names it; may be repeated. Else the first four."),
]
SceneFile = Annotated[
    str | None,
    Option(help="The scene that was compared in, for its meshes; a bundled one is found."),
]
Export = Annotated[
    Path | None, Option(metavar="FILE.html", help="Write the viewer to a file that needs nothing.")
]
Port = Annotated[int, Option(min=0, max=65535, help="To serve at; 0 for any that is free.")]


def view(
    run: Folder,
    *,
    policy: Policies = None,
    scene: SceneFile = None,
    export: Export = None,
    port: Port = 0,
    as_json: AsJson = False,
) -> None:
    """Show what policies draw along the first path, until Ctrl-C, or write it to a file."""
    from ..analysis.study.comparison_folder import read_results
    from ..analysis.view.view_page import render_view, require_levels
    from .shared.scene_output import check_output

    if export is not None:
        check_output(export, ".html")
    compared = read_results(run)
    require_levels(compared, policy or ())
    geometry, note = _find_meshes(compared.comparison, scene)
    page = render_view(compared, geometry, policy or (), note)
    if export is not None:
        from ..base.files.whole_file import write_whole

        write_whole(export, page)
        record = {"schema": "lodbench.view/1", "view": str(export)}
        print_result(record, f"view: {export}", as_json=as_json)
        return
    from ..analysis.view.view_server import ADDRESS, PageServer

    try:
        server = PageServer(page, port)
    except OSError as error:
        message = f"port: expected one that is free at {ADDRESS}, got {port}, {error.strerror}"
        raise InputError(f"{message}; name another, or 0 for any") from error
    record = {"schema": "lodbench.view/1", "url": server.url}
    print_result(record, f"view: {server.url}\nends with Ctrl-C", as_json=as_json)
    _serve(server)


def _serve(server: "PageServer") -> None:
    sys.stdout.flush()
    with server, suppress(KeyboardInterrupt):  # how it is meant to end
        server.serve_forever()


def _find_meshes(comparison: "Comparison", spec: str | None) -> "tuple[Geometry, str]":
    """Return the meshes of the scene that was compared in, or none and how to get them.

    Raises `InputError` if a scene is named that is another.
    """
    from ..base.content_hash import content_hash
    from ..models.scenes.scene_registry import SCENES

    wanted = comparison.provenance.hashes.get(f"scene {comparison.scene}")
    name = spec if spec is not None else comparison.scene
    if spec is None and name not in SCENES:
        return (), "For the meshes of its levels name the scene: lodbench view DIR --scene FILE."
    opened = open_named_scene(name)
    if content_hash(opened.scene) != wanted:
        if spec is not None:
            message = f"scene: expected {comparison.scene} as it was compared, got another"
            raise InputError(f"{message}; name its file as it was then")
        return (), "The bundled scene is another than was compared, and so are its meshes."
    return opened.read_geometry(), ""
