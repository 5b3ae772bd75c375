"""Making the bundled scenes: each in a process of its own, in bounded memory and time.

Time is counted in sorts of four million numbers in the same process, about a third of a second
each, so that a slow machine is not taken for slow code.
"""

import subprocess
import sys

import pytest

from lodbench.models.scene.scene_catalog import list_bundled_scenes

AIM_SORTS = 180.0
AIM_BYTES = 2 << 30

SCRIPT = """
import resource, sys, time
import numpy as np
from lodbench.models.scenes.scene_registry import find_builder

def taken_s(action):
    start = time.process_time()
    action()
    return time.process_time() - start

numbers = np.random.default_rng(0).random(4_000_000)
sort_s = min(taken_s(lambda: np.sort(numbers, kind="stable")) for _ in range(3))
make_s = taken_s(find_builder(sys.argv[1]))
print(make_s / sort_s, make_s, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024)
"""


@pytest.mark.parametrize("name", [*list_bundled_scenes(), "crowd-32768"])
def test_a_scene_is_made_in_time_and_memory(name: str) -> None:
    """Printed beside the aims."""
    done = subprocess.run([sys.executable, "-c", SCRIPT, name], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    sorts, taken_s, peak = map(float, done.stdout.split())
    print(
        f"\n{name}: {sorts:.1f} sorts (aim {AIM_SORTS:.0f}), {taken_s:.1f} s, "
        f"peak {peak / 2**20:.0f} MiB (aim {AIM_BYTES / 2**20:.0f})"
    )
    assert sorts < AIM_SORTS
    assert peak < AIM_BYTES
