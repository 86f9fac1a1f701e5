"""Commands that write files, killed at random moments and at every named place of writing: no file is ever half.

`CATSEYE_KILLS` says how often each is killed at random, `CATSEYE_SEED` repeats the moments.
"""

import os
import random
import signal
import time
from pathlib import Path

import pytest

from catseye.app.files.crash_points import FILE_POINTS
from tests.system.written_files import MATERIAL, OLD, Work, drafts, told

KILLS = int(os.environ.get("CATSEYE_KILLS", "24"))
SEED = int(os.environ.get("CATSEYE_SEED", "20261128"))
KILLED = -signal.SIGKILL


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("system", MATERIAL)
def test_a_killed_command_leaves_the_old_file_or_the_new(tmp_path: Path, system: str) -> None:
    measured = tmp_path / system
    measured.mkdir()
    for work in MATERIAL[system](measured):
        _killed(work, tmp_path)


def _killed(work: Work, folder: Path) -> None:
    rng = random.Random(f"{SEED} {work.name}")
    file = folder / work.name
    begun_s = time.monotonic()
    assert work.ended(folder) == 0, work
    took_s = time.monotonic() - begun_s
    whole = told(file.read_bytes())
    moments: list[tuple[str, float | None]] = [("", rng.uniform(0.0, took_s)) for _ in range(KILLS)]
    outcomes = {KILLED: 0, 0: 0}
    left = news = 0
    for crash, after_s in [*moments, *((place, None) for place in FILE_POINTS)]:
        file.write_bytes(OLD)
        outcomes[work.ended(folder, crash, after_s)] += 1
        found = file.read_bytes()
        assert found == OLD or told(found) == whole, f"{work} at {crash or after_s}: a file that is neither"
        news += found != OLD
        left += bool(drafts(folder))
    assert work.ended(folder) == 0, work
    assert told(file.read_bytes()) == whole
    assert drafts(folder) == []
    report(
        f"{' '.join(work.words[:1])} -o {work.name}: {outcomes[KILLED]} of {KILLS + len(FILE_POINTS)} killed before "
        f"their end, {news} times the whole new file stood there, else the old one; {left} hidden drafts were left "
        "and are gone; called again it wrote the same"
    )


def report(text: str) -> None:
    print(f"\n{text}, load {os.getloadavg()[0]:.1f}", flush=True)  # noqa: T201  # the figure
