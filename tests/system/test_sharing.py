"""Shared work as a whole: interrupted, killed, and over a real dask scheduler with workers of its own."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from distributed import Client

from catseye.app.cluster.errors import WorkerLostError
from catseye.app.cluster.sharing import sharing
from catseye.app.errors import ConfigError
from catseye.calibration.core.errors import UnidentifiableError
from tests.free_ports import free_port
from tests.patience import HANG_S
from tests.unit.app.cluster.work import drawn, fails_at_three, killed_at_three

ROOT = Path(__file__).parents[2]

LINGERING = """
import sys
from pathlib import Path
from catseye.app.cluster.sharing import sharing
from tests.unit.app.cluster.work import lingering

if __name__ == "__main__":
    with sharing(2, None) as share:
        share.map(lingering, [Path(sys.argv[1])] * 2)
"""


CONNECTING = """
import sys
from catseye.app.cluster import machines
from catseye.app.cluster.sharing import sharing
from catseye.app.cli.failure import write_failure

machines._CONNECT_S /= 5  # a fifth of the time that it gives a scheduler shows as well that it is bounded
try:
    with sharing(1, sys.argv[1]):
        pass
except Exception as error:
    sys.exit(write_failure(error))
"""


def wait_until(condition: Callable[[], bool], what: str, limit_s: float = HANG_S) -> None:
    end_s = time.monotonic() + limit_s
    while not condition():
        assert time.monotonic() < end_s, f"{what} took longer than {limit_s:g} s"
        time.sleep(0.02)


def is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{process}/stat")
    return not state.exists() or state.read_text().rpartition(")")[2].split()[0] != "Z"


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_whatever_ends_the_work_leaves_no_worker_behind(tmp_path: Path, ending: signal.Signals) -> None:
    script = tmp_path / "linger.py"
    script.write_text(LINGERING)
    process = subprocess.Popen(
        [sys.executable, str(script), str(tmp_path)],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    with process:
        wait_until(lambda: len(list(tmp_path.glob("*.running"))) == 2, "starting two workers")
        workers = [int(path.stem) for path in tmp_path.glob("*.running")]
        # Ctrl-C on a terminal goes to the whole group.
        (os.killpg if ending == signal.SIGINT else os.kill)(process.pid, ending)
        errors = process.communicate(timeout=HANG_S)[1].decode()
        wait_until(lambda: not any(is_running(worker) for worker in workers), "ending the workers")
    if ending == signal.SIGINT:
        assert errors.count("KeyboardInterrupt") == 1, "the workers themselves say nothing"


@contextmanager
def dask(*arguments: str, folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Run a command of dask until the context ends."""
    with (folder / f"{arguments[0]}.log").open("wb") as log:
        process = subprocess.Popen(
            [sys.executable, "-W", "ignore", "-m", "dask", *arguments, "--no-dashboard"],
            env=os.environ | {"PYTHONPATH": str(ROOT)},
            stdout=log,
            stderr=log,
            cwd=folder,
        )
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(20.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def answers(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    port = free_port()
    with dask("scheduler", "--port", str(port), folder=tmp_path_factory.mktemp("scheduler")):
        wait_until(lambda: answers(port), "starting the scheduler")
        yield f"tcp://127.0.0.1:{port}"


@pytest.fixture
def workers(scheduler: str, tmp_path: Path) -> Iterator[subprocess.Popen[bytes]]:
    with dask("worker", scheduler, "--nworkers", "2", "--nthreads", "1", folder=tmp_path) as process:
        yield process


def wait_for_workers(address: str) -> None:
    """Wait until both workers have reported: one that dies while it starts takes the other with it."""
    with Client(address) as client:
        client.wait_for_workers(2, timeout=HANG_S)


@pytest.mark.slow
@pytest.mark.usefixtures("workers")
def test_dask_gives_the_same_numbers_and_the_same_errors(scheduler: str) -> None:
    seen: list[int] = []
    wait_for_workers(scheduler)
    with sharing(1, scheduler) as share:
        found = share.map(drawn, np.random.SeedSequence(7).spawn(5), seen.append)
        with pytest.raises(UnidentifiableError, match="three") as caught:
            share.map(fails_at_three, range(8))
        # The scheduler blames each item that a dying worker had, also one that only waited there.
        with pytest.raises(WorkerLostError, match=r"lost item [1-8] of 8"):
            share.map(killed_at_three, range(8))
    assert found == [
        float(np.random.default_rng(seed).normal(size=1000).sum())
        for seed in np.random.SeedSequence(7).spawn(5)
    ]
    assert seen == [1, 2, 3, 4, 5]
    assert caught.value.__notes__[-1] == "in item 4 of 8: 3"


@pytest.mark.slow
def test_workers_that_all_go_are_reported_and_nothing_hangs(
    scheduler: str, workers: subprocess.Popen[bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("catseye.app.cluster.machines._LOOK_S", 0.4)
    wait_for_workers(scheduler)
    with sharing(1, scheduler) as share:

        def leave(_: int) -> None:
            workers.terminate()

        with pytest.raises(WorkerLostError, match="no worker of the dask scheduler is left"):
            share.map(pausing, [tmp_path] + [None] * 40, leave)


def pausing(_: object) -> None:
    """Take a moment."""
    time.sleep(1.0)


@pytest.mark.slow
def test_a_scheduler_without_workers_is_reported(scheduler: str) -> None:
    with pytest.raises(ConfigError, match="has no workers"), sharing(1, scheduler):
        pass


@pytest.mark.slow
def test_an_unanswered_address_is_reported_in_bounded_time(tmp_path: Path) -> None:
    address = f"tcp://127.0.0.1:{free_port()}"
    script = tmp_path / "connect.py"
    script.write_text(CONNECTING)
    answer = subprocess.run(
        [sys.executable, str(script), address],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=HANG_S,
        check=False,
    )
    assert f"no dask scheduler answers at {address}" in answer.stderr
    assert answer.returncode == 2
