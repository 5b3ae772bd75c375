"""Fixtures shared by all tests."""

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """The folder of real data; the test is skipped only where it is absent."""
    named = os.environ.get("LODBENCH_DATA")
    folder = Path(named) if named else Path(__file__).parents[1].parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"real data not found: no folder {folder.name}; set LODBENCH_DATA")
    return folder
