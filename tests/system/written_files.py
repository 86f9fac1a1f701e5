"""Commands that write files, on runs of all systems: which, and what they write without an interruption."""

import re
import shutil
import tempfile
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from tests.patience import HANG_S
from tests.system import forked
from tests.system.command import catseye, emulated, environment, last_run
from tests.system.serial_kills import SPEED, calibration, require_whole
from tests.system.trials import TRIALS, bench_of

NODES: Final = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-70.0, -40.0, -10.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 65.0, 90.0]",
}
"""The smallest plan with three reflectors whose maps can be identified."""

OLD: Final = b"what stood there before\n"
_TIMES: Final = re.compile(
    rb"20\d\d-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d+)?)?|20\d{6}T\d{6}Z"
    # As the style sheet of a report has it.
    rb"|20\d\d\\2d \d\d\\2d \d\d\\20 \d\d\\3a \d\d(\\3a \d\d)?"
)
"""When something was written differs between two calls."""


@dataclass(frozen=True)
class Work:
    """A command that writes a file.

    Attributes:
        name: of the file.
        words: of the command before `-o`.
    """

    name: str
    words: tuple[str, ...]

    def begun(self, folder: Path, crash: str, said: Path) -> forked.Forked:
        """Begin it."""
        env = {**environment(), "CATSEYE_CRASHPOINT": crash}
        with said.open("wb") as out:
            words = [*self.words, "-o", self.name]
            return forked.Forked("catseye", words, cwd=folder, env=env, out=out, err=out)

    def ended(self, folder: Path, crash: str = "", after_s: float | None = None) -> int:
        """Call it and return its exit code; it is killed at a place, or after so many seconds."""
        with tempfile.TemporaryDirectory() as talk:
            process = self.begun(folder, crash, Path(talk) / "said")
            if after_s is not None:
                killer = threading.Timer(after_s, process.kill)
                killer.start()
            code = process.wait(HANG_S)
            if after_s is not None:
                killer.cancel()
                killer.join()
            return code


def told(data: bytes) -> bytes:
    """Return what a file says, without when it was written."""
    return _TIMES.sub(b"", data)


def drafts(folder: Path) -> list[Path]:
    """Return what writers that were killed have left of files, under names that nothing reads."""
    return sorted(folder.glob(".*.draft"))


def _of_scara(folder: Path) -> list[Work]:
    with emulated(folder, "--seed", "5", edit=NODES) as bench:
        for procedure in ("reflector-search", "open-loop"):
            done = catseye("run", procedure, "--cell", bench.cell, "--speed", "400", cwd=folder)
            assert done.returncode == 0, done.stderr
    run = f"scara/catseye-runs/{last_run(folder, 'open-loop')}"
    Work("known.json", ("identify", run)).ended(folder.parent)
    path = folder.parent / "path.csv"
    rows = "\n".join(f"{angle},60,1,1" for angle in range(-60, -20, 5))
    path.write_text(f"theta1_deg,theta2_deg,direction1,direction2\n{rows}\n", encoding="utf-8")
    return [
        Work("result.json", ("identify", run)),
        Work("monte-carlo.json", ("identify", run, "--uncertainty", "monte-carlo", "--draws", "2000")),
        Work("run.html", ("report", run)),
        Work("result.html", ("report", "known.json")),
        Work("points.csv", ("export", run, "--format", "csv")),
        Work("run.json", ("export", run, "--format", "json")),
        Work("run.parquet", ("export", run, "--format", "parquet")),
        Work("predicted.csv", ("predict", "known.json", "--path", "path.csv")),
        Work("corrected.csv", ("compensate", "known.json", "--path", "path.csv", "--format", "csv")),
    ]


def _of_kuka(folder: Path) -> list[Work]:
    (trial,) = [trial for trial in TRIALS if trial.procedure == "resolution"]
    with bench_of(trial.system, folder) as bench:
        story = trial.story(bench)
        assert story.live().returncode == 0, story.lives[-1].stderr
    run = str(story.path)
    return [
        Work("steps.csv", ("export", run, "--format", "csv")),
        Work("steps.parquet", ("export", run, "--format", "parquet")),
    ]


def _of_abb(folder: Path) -> list[Work]:
    with emulated(folder, "--seed", "3", "--speed", SPEED, text=TEMPLATES[SIX_AXIS].text) as bench:
        story = calibration(bench)
        require_whole(story)
    run = str(story.path)
    shutil.copy(folder / "cell.toml", folder.parent / "abb.toml")
    return [
        Work("arm.json", ("calibrate", run, "--model", "frames")),
        Work("poses.csv", ("export", run, "--format", "csv")),
        Work("poses.html", ("report", run)),
    ]


MATERIAL: Final = {"scara": _of_scara, "kuka": _of_kuka, "abb": _of_abb}
"""Measures in a folder of the system's own and returns what is done with the runs, in the folder above."""
