"""The whole job on emulated hardware over real sockets."""

import asyncio
import json
import signal
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from catseye.app.cell.load import LoadedCell, load_cell
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.engine.announcer import Publish
from catseye.app.engine.request import RunOutcome
from catseye.app.engine.signals import loop_signals
from catseye.app.errors import CatseyeError, InterruptedRunError, TerminatedRunError, UsageError
from catseye.app.exitcode import ExitCode
from catseye.app.files.atomic import write_atomically
from catseye.app.files.documents import read_truth
from catseye.app.protocol.procedures import analysed_by, on_the_way, parse_params
from catseye.app.results.runs.run_source import are_simulated
from catseye.app.results.scara.budget_part import BudgetPart
from catseye.app.results.scara.export import run_export
from catseye.app.results.scara.identify import (
    MODELS,
    bench_of_runs,
    identified_result,
    identify_points,
    run_points,
)
from catseye.app.results.scara.path_rows import path_measurement
from catseye.app.results.scara.result import Result, write_result
from catseye.app.results.scara.stated_budget import budget_of_runs
from catseye.app.results.scara.truth import TruthComparison, compare_with_truth
from catseye.app.results.scara.uncertainty import by_jacobian
from catseye.app.results.scara.validation import PathValidation, validate_on_path
from catseye.app.service.emulation import EmulatorProcess, emulator_process, fetch_truth
from catseye.app.service.running import PlannedRun, carry_out, plan_run
from catseye.app.service.scara.emulation import emulation_config
from catseye.app.store.reader import RunReader
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.layout import ModelName
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.scara.bench import ScaraBench
from catseye.simulators.world.scara.truth import true_arm

_PORTS = ("10001", "10002", "10502", "10099")


class DemoInterruptedError(CatseyeError):
    """A run of the demo did not complete.

    Args:
        outcome: how it ended.
    """

    def __init__(self, outcome: RunOutcome) -> None:
        super().__init__(f"the demo ends here: run {outcome.path.name} is {outcome.status}: {outcome.text}")
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
class DemoResult:
    """Everything that the demo found.

    Attributes:
        folder: where its files are.
        runs: run folders by procedure.
        identified: what the solver returned, by model.
        results: the same as files hold it.
        truth: identified against true values.
        validation: both models on the validation path.
    """

    folder: Path
    runs: dict[str, Path]
    identified: dict[ModelName, Identification]
    results: dict[ModelName, Result]
    truth: TruthComparison
    validation: PathValidation


async def measure(
    folder: Path, speed: float, seed: int, truth: Path | None, publish: Callable[[str], Publish]
) -> dict[str, Path]:
    """Start the emulators, run search, measurement and validation path, keep the truth.

    Args:
        speed: bench seconds in one real second.
        truth: result JSON with the true arm; None draws one.
        publish: makes what takes the events of each run.

    Returns:
        The run folders by procedure.

    Raises:
        DemoInterruptedError: a run did not complete.
        InterruptedRunError: Ctrl-C between two runs.
        TerminatedRunError: SIGTERM or SIGHUP between two runs.
    """
    signals = _Signals()
    with loop_signals(signals.deliver):
        try:
            return await _measure(folder, speed, seed, truth, publish, signals)
        except asyncio.CancelledError:
            if signals.ended_by is None:
                raise
            raise signals.error() from None


async def _measure(
    folder: Path,
    speed: float,
    seed: int,
    truth: Path | None,
    publish: Callable[[str], Publish],
    signals: _Signals,
) -> dict[str, Path]:
    emulated = folder / "emulator.toml"
    write_atomically(emulated, _with_ports(TEMPLATE, ["0"] * len(_PORTS)))
    async with emulator_process(emulated, speed, seed, truth) as process:
        loaded = _live_cell(folder, process)
        document = await fetch_truth(process.endpoints["control"])
        write_atomically(folder / "truth.json", json.dumps(document, indent=1) + "\n")
        runs: dict[str, Path] = {}
        for procedure in on_the_way():
            if procedure.demo is None:
                continue
            name = procedure.name
            planned = _planned(loaded, procedure, folder / "runs")
            outcome = await carry_out(
                planned, folder / "runs", publish(name), speed=speed, install_signals=signals.to_run
            )
            if outcome.exit_code != ExitCode.DONE:
                raise DemoInterruptedError(outcome)
            runs[name] = outcome.path
        return runs


def _planned(loaded: LoadedCell, procedure: Procedure, root: Path) -> PlannedRun:
    params = parse_params(procedure.params_type, list(procedure.demo or ()))
    return plan_run(loaded, procedure, params, root, "auto")


def run_for(command: str, runs: dict[str, Path]) -> Path:
    """Return the run that a command works on.

    Args:
        command: identify, validate.
        runs: folders of runs by procedure.
    """
    return next(runs[each.name] for each in analysed_by(command) if each.name in runs)


def evaluate(folder: Path, runs: dict[str, Path]) -> DemoResult:
    """Identify both models, compare them with the truth and on the validation path; write the files."""
    measured = RunReader(run_for("identify", runs))
    bench = bench_of_runs([measured], folder / "runs")
    points = run_points([measured])
    write_atomically(folder / "points.csv", run_export(measured).csv)
    stated = budget_of_runs([measured])
    identified = {model: identify_points(points, bench, model, stated.budget) for model in MODELS}
    results = {
        model: _result(identification, bench, stated.part, measured)
        for model, identification in identified.items()
    }
    for model, result in results.items():
        write_result(result, folder / f"result-{model}.json")
    document: dict[str, Any] = read_truth(folder / "truth.json")
    nominal = (bench.link1_mm, bench.link2_mm)
    path = path_measurement(RunReader(run_for("validate", runs)), bench.take_up_deg)
    return DemoResult(
        folder,
        runs,
        identified,
        results,
        compare_with_truth(identified["error-map"], document),
        validate_on_path(path, [identification.arm for identification in identified.values()], nominal),
    )


def _result(identified: Identification, bench: ScaraBench, budget: BudgetPart, measured: RunReader) -> Result:
    result = identified_result(identified, bench, [measured.path.name], budget, are_simulated([measured]))
    return result.model_copy(update={"uncertainty": by_jacobian(identified).part})


def prepare_folder(folder: Path, seed: int, truth: Path | None) -> None:
    """Look at the truth file, then make the demo's folder.

    Raises:
        ConfigError: the truth file cannot be read; nothing is written.
        EmulatorError: it does not fit; nothing is written.
        UsageError: the folder cannot be made.
    """
    config = emulation_config(Cell.model_validate(tomllib.loads(TEMPLATE)), 1.0, seed, truth)
    if config.truth is not None:
        true_arm(config.truth, config)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(
            f"{folder}: no folder can be made there: {error.strerror}; choose another --out"
        ) from error


def _live_cell(folder: Path, process: EmulatorProcess) -> LoadedCell:
    """Write and load the cell file with the ports that the emulators really use."""
    order = ("robot", "interferometer", "environment", "control")
    ports = [process.endpoints[device].rpartition(":")[2] for device in order]
    path = folder / "cell.toml"
    write_atomically(path, _with_ports(TEMPLATE, ports))
    return load_cell(path)


def _with_ports(text: str, ports: list[str]) -> str:
    for old, new in zip(_PORTS, ports, strict=True):
        text = text.replace(f"tcp://127.0.0.1:{old}", f"tcp://127.0.0.1:{new}")
    return text
