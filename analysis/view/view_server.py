"""A server of one page to this machine alone, until it is interrupted."""

import secrets
import sys
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, ClassVar

ADDRESS = "127.0.0.1"

_HEADERS = {
    "Content-Type": "text/html; charset=utf-8",
    "Content-Security-Policy": "default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


class PageServer(ThreadingHTTPServer):
    """Serves a page below a random path, to requests that name this machine.

    Other pages in a browser know neither the path, nor can they make a name of their own stand for
    this address: the host of a request has to be the address itself.

    Attributes
    ----------
    url : str
    """

    daemon_threads = True

    def __init__(self, page: str, port: int = 0) -> None:
        """Bind a port, any that is free for 0; raises OSError if it cannot be had."""
        token = secrets.token_urlsafe(24)
        served = {"page": page.encode(), "path_of_page": f"/{token}/"}
        handler = type("Handler", (_Handler,), served)
        super().__init__((ADDRESS, port), handler)
        handler.host = f"{ADDRESS}:{self.server_port}"  # before any request is taken
        self.url = f"http://{handler.host}/{token}/"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Keep quiet of a browser that left before it had the page."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """Answers GET and HEAD of the page; all else is an error."""

    page: ClassVar[bytes]
    path_of_page: ClassVar[str]
    host: ClassVar[str]
    protocol_version = "HTTP/1.1"
    timeout = 30

    def do_GET(self) -> None:
        if self._answer():
            self.wfile.write(self.page)

    def do_HEAD(self) -> None:
        self._answer()

    def _answer(self) -> bool:
        asked = secrets.compare_digest(self.path.encode(), self.path_of_page.encode())
        if not asked or self.headers.get("Host") != self.host:
            self.send_error(HTTPStatus.NOT_FOUND)
            return False
        self.send_response(HTTPStatus.OK)
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(self.page)))
        self.end_headers()
        return True

    def version_string(self) -> str:
        return "lodbench"

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - the library's name
        """Keep requests to ourselves."""
