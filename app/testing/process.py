"""`catseye emulate` in a process of its own, for tests."""

import json
import re
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.testing.bench import RunningBench, by_name

_READY_TIMEOUT_S = 60.0
_END_TIMEOUT_S = 5.0


@contextmanager
def bench_in_process(
    cell: Path | None = None, *, speed: float = 1.0, seed: int = 0
) -> Iterator[RunningBench]:
    """Run `catseye emulate` and yield its endpoints; the process is killed at the end, whatever happens.

    Args:
        cell: cell file; None takes the template of `catseye init`, on free ports.
        speed: bench seconds in one real second.

    Raises:
        RuntimeError: it did not come up; the text is what it said.
    """
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile() as said:
        file = cell or _template(Path(folder))
        choices = ["--speed", f"{speed:g}", "--seed", str(seed), "--end-with-stdin"]
        process = subprocess.Popen(
            # -P: a folder named app in the host project is not taken for ours.
            [sys.executable, "-P", "-m", "catseye", "emulate", str(file), *choices],
            # The pipe closes with this process, however it ends, and the emulator with the pipe.
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=said,
        )
        try:
            yield RunningBench(*by_name(_served(process, said)))
        finally:
            _end(process)


def _template(folder: Path) -> Path:
    file = folder / "cell.toml"
    file.write_text(re.sub(r"127\.0\.0\.1:\d+", "127.0.0.1:0", TEMPLATE), encoding="utf-8")
    return file


def _served(process: subprocess.Popen[bytes], said: IO[bytes]) -> list[tuple[str, str]]:
    """Return device and endpoint of what the process serves; the control port comes last."""
    watchdog = threading.Timer(_READY_TIMEOUT_S, process.kill)
    watchdog.start()
    served: list[tuple[str, str]] = []
    try:
        while not served or served[-1][0] != "control":
            line = process.stdout.readline() if process.stdout else b""
            if not line:
                said.seek(0)
                text = said.read().decode(errors="replace").strip()
                raise RuntimeError(f"the emulator did not start: {text or 'it said nothing'}")
            row = json.loads(line)
            served.append((row["device"], row["endpoint"]))
    finally:
        watchdog.cancel()
        watchdog.join()
    return served


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.communicate(timeout=_END_TIMEOUT_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
