"""What a newcomer waits for `make demo`."""

import time
from pathlib import Path

from tests.system.command import start

AIM_S = 60.0
"""On a machine with nothing else to do; how long a busy one takes says nothing about the program."""


def test_demo_does_the_whole_job(tmp_path: Path) -> None:
    began_s = time.monotonic()
    process = start("demo", "--out", tmp_path / "demo", cwd=tmp_path)
    _, stderr = process.communicate()
    taken_s = time.monotonic() - began_s
    print(f"\n{taken_s:.1f} s for the demo (aim {AIM_S:g} s)")  # noqa: T201  # the figure
    assert process.returncode == 0, stderr
