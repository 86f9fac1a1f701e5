"""Runs with an injected clock that are killed at a named place and gone on with, compared bit for bit."""

import json
import signal
from pathlib import Path
from typing import Any

from catseye.app.store.catalog import list_runs
from catseye.app.store.reader import RunReader
from catseye.app.store.seal import read_manifest
from catseye.app.store.verify import verify
from tests.patience import HANG_S
from tests.system import forked
from tests.system.command import environment


def lived(root: Path, run: Path | None = None, crash: str = "") -> int:
    """Begin a run, or go on with one, until its end or its death; return the exit code."""
    words = [str(root), *([] if run is None else [str(run)])]
    env = {**environment(), "CATSEYE_CRASHPOINT": crash}
    done = forked.run("tests.system.clocked_runs", words, cwd=root, env=env, limit_s=HANG_S)
    assert done.returncode == -signal.SIGKILL or done.stdout == "complete\n", done.stderr
    return done.returncode


def whole(root: Path, *crashes: str) -> str:
    """Return, as text, what a run has stored that died at each of these places; "" if it does not pass one."""
    root.mkdir(parents=True)
    run: Path | None = None
    for crash in crashes:
        if lived(root, run, crash) == 0:
            return ""
        run = _begun(root)
    if run is None or read_manifest(run) is None:
        assert lived(root, run) == 0
    return stored(list_runs(root)[-1].path)


def _begun(root: Path) -> Path | None:
    """Return the run to go on with; None if it died before it had described itself."""
    runs = [each for each in list_runs(root) if each.status != "damaged"]
    return runs[-1].path if runs else None


def stored(run: Path) -> str:
    """Return what was measured at each pose, as JSON: floats stand there with all of their bits.

    Fixed nests are measured once more by a run that was interrupted: that round, and its number, are left out.
    """
    reader = RunReader(run)
    assert reader.status == "complete"
    assert verify(run).ok
    steps: list[Any] = [
        [step.step_id, step.result] for step in reader.steps() if step.step_id.startswith("pose/")
    ]
    left_out = {"attempt", "nests_round", "extra"}
    rows = [
        {name: value for name, value in row.items() if name not in left_out} for row in reader.rows("targets")
    ]
    return json.dumps([steps, rows], sort_keys=True)
