"""Making the bundled scenes: at most 60 s and 2 GB each, in a process of its own."""

import subprocess
import sys

import pytest

from lodbench.models.scene.scene_catalog import list_bundled_scenes

AIM_S = 60.0
AIM_BYTES = 2 << 30

SCRIPT = """
import resource, sys, time
from lodbench.models.scenes.scene_registry import find_builder

start = time.perf_counter()
find_builder(sys.argv[1])()
print(time.perf_counter() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
"""


@pytest.mark.parametrize("name", [*list_bundled_scenes(), "crowd-32768"])
def test_a_scene_is_made_in_time_and_memory(name: str) -> None:
    """Printed beside the aims."""
    done = subprocess.run([sys.executable, "-c", SCRIPT, name], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    taken_s, peak = map(float, done.stdout.split())
    print(
        f"\n{name}: {taken_s:.1f} s (aim {AIM_S:.0f}), peak {peak / 2**20:.0f} MiB "
        f"(aim {AIM_BYTES / 2**20:.0f})"
    )
    assert taken_s < AIM_S
    assert peak < AIM_BYTES
