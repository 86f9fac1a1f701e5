"""Commands that write files on a disk that fails, or is really full: a sentence, exit code 6, the old file stays."""

import os
import random
import shutil
import subprocess
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from catseye.app.exitcode import ExitCode
from catseye.app.store.catalog import list_runs
from tests.patience import HANG_S
from tests.system.command import environment
from tests.system.disk_losses import require_stopped
from tests.system.failing_disk import CALLS, FAULTS, FailingDisk
from tests.system.interruptions import Moment, spawned
from tests.system.procedure_kills import Reference, to_its_end
from tests.system.trials import TRIALS, bench_of
from tests.system.written_files import MATERIAL, OLD, Work, drafts, told

SEED = int(os.environ.get("CATSEYE_SEED", "20261128"))
NUMBER = int(os.environ.get("CATSEYE_FAULTS", "12"))
DISK_MB = 230
"""Room for the reserve that a run asks for, and a little more."""


@pytest.mark.timeout(7200)
def test_a_file_that_cannot_be_written_stays_as_it_was(tmp_path: Path) -> None:
    measured = tmp_path / "scara"
    measured.mkdir()
    out = tmp_path / "out"
    out.mkdir()
    disk, rng = FailingDisk.built(tmp_path, out), random.Random(SEED)
    for work in MATERIAL["scara"](measured):
        found = _refused(work, tmp_path, disk, rng)
        report(
            f"{work.words[0]} -o {work.name}: {dict(found)}; exit code 6, the old file stands, no draft is left"
        )
        full = tmp_path / f"full-{work.name}"
        full.symlink_to("/dev/full")
        code, said = _written(work, tmp_path, full, {})
        assert code == ExitCode.STORAGE, said
        assert "No space left" in said


def _refused(work: Work, folder: Path, disk: FailingDisk, rng: random.Random) -> Counter[str]:
    file, found = disk.folder / work.name, Counter[str]()
    assert _written(work, folder, file, {})[0] == 0
    whole = told(file.read_bytes())
    for _ in range(NUMBER):
        file.write_bytes(OLD)
        fault, calls = rng.choice(list(FAULTS)), rng.choice(CALLS)
        order = disk.order(fault, calls, rng.choice([1, 1, 1, 2, 3]), rng.choice([0, 1, 100]))
        code, said = _written(work, folder, file, order)
        if not disk.struck:
            assert (code, told(file.read_bytes())) == (0, whole), said
            found["not reached"] += 1
            continue
        assert code == ExitCode.STORAGE, (disk.struck, said)
        assert "Traceback" not in said, said
        assert work.name in said, said
        assert file.read_bytes() == OLD, disk.struck
        # Nothing can be removed from a disk that takes no more changes of names.
        assert drafts(disk.folder) == [] or calls in {"name", "all"}
        for draft in drafts(disk.folder):
            draft.unlink()
        found[fault] += 1
    return found


def _written(work: Work, folder: Path, file: Path, order: dict[str, str]) -> tuple[int, str]:
    said = folder / "said"
    with (
        said.open("wb") as err,
        spawned(
            *("catseye", [*work.words, "-o", str(file)]),
            cwd=folder,
            env={**environment(), **order},
            err=err,
        ) as (process, lines),
    ):
        lines.read()
        code = process.wait(HANG_S)
    return code, said.read_text("utf-8")


@contextmanager
def _small_disk(folder: Path) -> Iterator[Path]:
    """Mount a small disk; skip the test where that is not permitted."""
    folder.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={DISK_MB}m", "tmpfs", folder], check=False, capture_output=True
    )
    if mounted.returncode != 0:
        pytest.skip(f"nobody may mount a small disk here: {mounted.stderr.decode().strip()}")
    try:
        yield folder
    finally:
        subprocess.run(["umount", "-l", folder], check=True)


@pytest.mark.timeout(7200)
def test_a_disk_that_is_really_full_stops_the_run(tmp_path: Path) -> None:
    (trial,) = [trial for trial in TRIALS if trial.procedure == "tracker-validation"]
    rng = random.Random(SEED)
    with _small_disk(tmp_path / "disk") as folder, bench_of(trial.system, folder) as bench:
        reference, points = Reference.of(trial, bench), 0
        for _ in range(NUMBER):
            story = trial.story(bench)
            filler = folder / "filler"

            def fill(_pid: int, filler: Path = filler) -> None:
                with filler.open("wb") as file:
                    while True:
                        try:
                            file.write(bytes(1 << 16))
                            file.flush()
                        except OSError:
                            return

            life = story.live(
                moment=Moment(rng.randint(3, reference.events - 5), 0.0), strike=fill, repair=filler.unlink
            )
            require_stopped(life, bench, "really full")
            points += len(life.points)
            to_its_end(trial, story, reference)
            for run in list_runs(folder / "catseye-runs"):
                shutil.rmtree(run.path)
    report(f"a disk of {DISK_MB} MB filled under {NUMBER} runs: {points} points reported before, all stored")


def report(text: str) -> None:
    print(f"\n{text}, load {os.getloadavg()[0]:.1f}", flush=True)  # noqa: T201  # the figure
