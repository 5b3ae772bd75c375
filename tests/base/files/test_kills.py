"""A process that is killed at any of its steps on the disk leaves the old result or the new one."""

import subprocess
import sys
from pathlib import Path

import pytest

# Each step is tried by a process that is forked for it and kills itself there; what it leaves is
# judged, and then written over by a run that nobody disturbs.
CODE = """
import os, signal, sys
from pathlib import Path
from lodbench.base.files import whole_folder
from lodbench.base.files.whole_file import write_whole

STEPS = {"open", "fcntl.flock", "os.mkdir", "os.rename", "os.remove", "os.rmdir", "os.truncate"}
root, what = Path(sys.argv[1]), sys.argv[2]
if what == "two renames":
    whole_folder.exchange = lambda *_: False


def write(content):
    if what == "file":
        write_whole(root / "run", content)
        return
    with whole_folder.claimed_folder(root / "run", "(old|new)", "record"):
        with whole_folder.whole_folder(root / "run") as folder:
            (folder / content).write_text(content)


def found():
    path = root / "run"
    if what == "file":
        return path.read_text()
    (only,) = path.iterdir()
    assert only.read_text() == only.name
    return only.name


def killed_at(step):
    child = os.fork()
    if child:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL
    seen = 0

    def count(event, _):
        nonlocal seen
        seen += event in STEPS
        if seen > step and event in STEPS:
            os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(count)
    write("new")
    os._exit(0)


write("old")
step, absent, left = 0, 0, {"old": 0, "new": 0}
while killed_at(step):
    if (root / "run").exists():
        left[found()] += 1
    else:
        absent += 1
        write_whole(root / "beside", "")
        assert sorted(os.listdir(root)) == ["beside", "run"]
        (root / "beside").unlink()
        assert found() == "old"
    write("old")
    assert os.listdir(root) == ["run"], os.listdir(root)
    step += 1
assert found() == "new"
print(absent, left["old"], left["new"])
"""


@pytest.mark.skipif(sys.platform != "linux", reason="kills forked processes, and exchanges")
@pytest.mark.parametrize("what", ["folder", "two renames", "file"])
def test_a_kill_at_any_step_leaves_the_old_or_the_new(tmp_path: Path, what: str) -> None:
    """A whole result stands under the name; the next run leaves nothing else in the folder.

    Where a file system cannot exchange, the old folder is away for an instant, and any write beside
    it brings it back.
    """
    done = subprocess.run(
        [sys.executable, "-c", CODE, str(tmp_path), what],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    absent, old, new = map(int, done.stdout.split())
    assert (absent > 0) == (what == "two renames")
    assert old >= 5
    assert new >= 2
