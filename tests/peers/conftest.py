"""Peers' own code, run by node: a document in, a document out."""

import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent
ASK = "code of peers not found: install node and run `npm ci` in tests/peers"
"""What `.ci/run` looks for: there no test of a peer may be skipped."""

RunPeer = Callable[[str, dict[str, Any]], Any]


@pytest.fixture(scope="session")
def run_peer() -> RunPeer:
    """Return a function from a script of this folder and its input to its output."""
    node = shutil.which("node")
    if node is None or not (HERE / "node_modules").is_dir():
        pytest.skip(ASK)

    def run(script: str, document: dict[str, Any]) -> Any:
        done = subprocess.run(
            [node, str(HERE / script)],
            input=json.dumps(document),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run
