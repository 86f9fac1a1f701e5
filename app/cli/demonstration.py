"""What demonstrations have in common: an emulated bench of their own, runs on it, and signals meanwhile."""

import asyncio
import json
import re
import signal
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Iterator, Sequence
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from itertools import repeat
from pathlib import Path
from typing import TypeVar

from catseye.app.cell.load import LoadedCell, load_cell
from catseye.app.engine.announcer import Publish
from catseye.app.engine.heap import settled_heap
from catseye.app.engine.request import RunOutcome
from catseye.app.engine.signals import SignalInstaller, loop_signals
from catseye.app.errors import CatseyeError, InterruptedRunError, TerminatedRunError, UsageError
from catseye.app.exitcode import ExitCode
from catseye.app.files.atomic import write_atomically
from catseye.app.protocol.procedures import parse_params
from catseye.app.service.emulation import emulator_process, fetch_truth
from catseye.app.service.running import carry_out, plan_run
from catseye.procedures.kit.procedure import Procedure

_DEVICES = ("robot", "interferometer", "environment", "control")
"""In the order of their endpoints in a cell file."""

JobT = TypeVar("JobT")


class DemoInterruptedError(CatseyeError):
    """A run of the demo did not complete.

    Args:
        outcome: how it ended.
        advice: what to do about it in a demonstration.
    """

    def __init__(self, outcome: RunOutcome, advice: str = "") -> None:
        text = f"the demo ends here: run {outcome.path.name} is {outcome.status}: {outcome.text}"
        super().__init__(f"{text}. {advice}" if advice else text)
        self.outcome = outcome


class _Signals:
    """Delivers signals to the run under way, and ends the demo between runs."""

    def __init__(self) -> None:
        self._demo = asyncio.current_task()
        self._run: Callable[[int], None] | None = None
        self.ended_by: int | None = None

    def deliver(self, number: int) -> None:
        """Take a signal of the process."""
        if self._run is not None:
            self._run(number)
        elif number != signal.SIGUSR1 and self._demo is not None:
            self.ended_by = number
            self._demo.cancel()

    @contextmanager
    def to_run(self, on_signal: Callable[[int], None]) -> Iterator[None]:
        """Let a run have the signals while it is under way."""
        self._run = on_signal
        try:
            yield
        finally:
            self._run = None

    def error(self) -> CatseyeError:
        """Return what the signal between two runs means."""
        text = "the demo was ended between two runs; no robot was moving"
        return InterruptedRunError(text) if self.ended_by == signal.SIGINT else TerminatedRunError(text)


@dataclass(frozen=True)
class Demonstration:
    """What a demonstration is given.

    Attributes:
        folder: for everything that it writes.
        speed: bench seconds in one real second.
        seed: of everything random.
        truth: file with the true arm; None draws one.
        publish: makes what takes the events of a run, by the name of its procedure.
    """

    folder: Path
    speed: float
    seed: int
    truth: Path | None
    publish: Callable[[str], Publish]

    @property
    def runs(self) -> Path:
        """Folder of its runs."""
        return self.folder / "runs"

    @property
    def truth_file(self) -> Path:
        """Where the truth of the emulated bench is kept."""
        return self.folder / "truth.json"

    @property
    def cell_file(self) -> Path:
        """The cell with the ports of its emulators."""
        return self.folder / "cell.toml"


async def interruptible(job: Callable[[SignalInstaller], Awaitable[JobT]]) -> JobT:
    """Return what a job returns that is given how its runs have the signals of the process.

    Raises:
        InterruptedRunError: Ctrl-C between two runs.
        TerminatedRunError: SIGTERM or SIGHUP between two runs.
    """
    signals = _Signals()
    with loop_signals(signals.deliver):
        try:
            return await job(signals.to_run)
        except asyncio.CancelledError:
            if signals.ended_by is None:
                raise
            raise signals.error() from None


@asynccontextmanager
async def emulated_bench(
    given: Demonstration, cell: str, emulated: str | None = None
) -> AsyncIterator[LoadedCell]:
    """Serve the bench of a cell file on free ports; yield the cell with these ports, and keep the truth.

    Args:
        cell: text of the cell file, with the endpoints of robot, interferometer, environment and bench's tracker.
        emulated: text of the emulator's, where that says more of the devices than their drivers take.

    Raises:
        LinkFailedError: the emulators did not come up.
    """
    async with emulators(given, emulated or cell) as endpoints:
        yield live_cell(given.cell_file, cell, [endpoints[device] for device in _DEVICES])


@asynccontextmanager
async def emulators(given: Demonstration, cell: str) -> AsyncIterator[dict[str, str]]:
    """Serve the bench of a cell file on free ports; yield the endpoints of its devices, and keep the truth.

    Args:
        cell: text of the cell file; every endpoint of it is one of the loopback address.

    Raises:
        LinkFailedError: the emulators did not come up.
    """
    emulator = given.folder / "emulator.toml"
    write_atomically(emulator, _with_ports(cell, repeat("0")))
    async with emulator_process(emulator, given.speed, given.seed, given.truth) as process:
        document = await fetch_truth(process.endpoints["control"])
        write_atomically(given.truth_file, json.dumps(document, indent=1) + "\n")
        yield process.endpoints


async def run_each(
    given: Demonstration,
    loaded: LoadedCell,
    chosen: Iterable[tuple[Procedure, Sequence[str]]],
    install_signals: SignalInstaller,
) -> list[Path]:
    """Plan and carry out one procedure after another; return their run folders.

    Args:
        chosen: procedures with their parameters, as on the command line.

    Raises:
        DemoInterruptedError: a run did not complete.
    """
    paths = []
    for procedure, texts in chosen:
        params = parse_params(procedure.params_type, list(texts))
        planned = plan_run(loaded, procedure, params, given.runs, "auto")
        with settled_heap():
            outcome = await carry_out(
                planned,
                given.runs,
                given.publish(procedure.name),
                speed=given.speed,
                install_signals=install_signals,
            )
        if outcome.exit_code != ExitCode.DONE:
            raise DemoInterruptedError(outcome)
        paths.append(outcome.path)
    return paths


def make_folder(folder: Path) -> None:
    """Make the folder of a demonstration.

    Raises:
        UsageError: it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(
            f"{folder}: no folder can be made there: {error.strerror}; choose another --out"
        ) from error


def live_cell(path: Path, cell: str, endpoints: Sequence[str]) -> LoadedCell:
    """Write and load a cell file with the ports that emulators really use.

    Args:
        cell: text of the file.
        endpoints: in the order in which the text has them.
    """
    write_atomically(path, _with_ports(cell, (endpoint.rpartition(":")[2] for endpoint in endpoints)))
    return load_cell(path)


def _with_ports(text: str, ports: Iterable[str]) -> str:
    left = iter(ports)
    return re.sub(r'(?<= = "tcp://127\.0\.0\.1:)\d+', lambda _: next(left), text, flags=re.MULTILINE)
