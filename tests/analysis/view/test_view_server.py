"""The viewer's server: this machine alone, whoever has the address, and nothing but the page."""

import http.client
import socket
import struct
import threading
import time
from collections.abc import Iterator

import pytest

from lodbench.analysis.view.view_server import ADDRESS, PageServer


@pytest.fixture
def server() -> Iterator[PageServer]:
    """Serve a page in a thread."""
    with PageServer("<p>é</p>") as served:
        thread = threading.Thread(target=served.serve_forever, args=(0.01,))
        thread.start()
        yield served
        served.shutdown()
        thread.join()


def ask(
    server: PageServer, path: str, method: str = "GET", **headers: str
) -> tuple[int, bytes, dict[str, str]]:
    """Return status, body and headers of an answer."""
    connection = http.client.HTTPConnection(ADDRESS, server.server_port, timeout=5)
    connection.request(method, path, headers=headers)
    answer = connection.getresponse()
    found = answer.status, answer.read(), dict(answer.getheaders())
    connection.close()
    return found


def test_the_page_is_at_the_address_that_is_told(server: PageServer) -> None:
    """The address has 24 random bytes; scripts of others and frames around it are refused."""
    token = server.url.removeprefix(f"http://{ADDRESS}:{server.server_port}/").rstrip("/")
    assert len(token) == 32
    assert server.server_address[0] == "127.0.0.1"
    status, body, headers = ask(server, f"/{token}/")
    assert (status, body) == (200, "<p>é</p>".encode())
    assert "default-src 'none'" in headers["Content-Security-Policy"]
    assert headers["Cache-Control"] == "no-store"
    assert ask(server, f"/{token}/", "HEAD")[:2] == (200, b"")


@pytest.mark.parametrize("path", ["/", "/x/", "/../etc/passwd", "http://other/", "/%00"])
def test_nothing_else_is_there(server: PageServer, path: str) -> None:
    """Without the token there is neither page nor file."""
    status, body, _ = ask(server, path)
    assert status == 404
    assert "é".encode() not in body


def test_a_name_that_stands_for_this_address_is_refused(server: PageServer) -> None:
    """A page elsewhere, whose name was made to lead here, cannot read ours."""
    path = "/" + server.url.rsplit("/", 2)[1] + "/"
    assert ask(server, path, Host=f"evil.example:{server.server_port}")[0] == 404


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS"])
def test_it_is_read_only(server: PageServer, method: str) -> None:
    """Methods that write are not known."""
    path = "/" + server.url.rsplit("/", 2)[1] + "/"
    assert ask(server, path, method)[0] == 501


def test_a_browser_that_leaves_early_is_no_error(capsys: pytest.CaptureFixture[str]) -> None:
    """It resets the connection while a page of 20 MB is on its way."""
    with PageServer("x" * 20_000_000) as served:
        thread = threading.Thread(target=served.serve_forever, args=(0.01,))
        thread.start()
        before = threading.active_count()
        path = "/" + served.url.rsplit("/", 2)[1] + "/"
        asked = socket.create_connection((ADDRESS, served.server_port), timeout=5)
        host = f"{ADDRESS}:{served.server_port}"
        asked.sendall(f"GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
        assert asked.recv(1000)
        asked.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        asked.close()
        end = time.monotonic() + 5.0
        while threading.active_count() > before and time.monotonic() < end:  # the request's thread
            time.sleep(0.01)
        assert ask(served, path)[0] == 200
        served.shutdown()
        thread.join()
    assert capsys.readouterr().err == ""


def test_each_address_is_another() -> None:
    """Two servers have two tokens."""
    with PageServer("") as one, PageServer("") as other:
        assert one.url.rsplit("/", 2)[1] != other.url.rsplit("/", 2)[1]
