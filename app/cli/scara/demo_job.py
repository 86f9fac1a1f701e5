"""The whole job on emulated hardware over real sockets."""

import tomllib
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.demonstration import (
    Demonstration,
    emulated_bench,
    interruptible,
    make_folder,
    run_each,
)
from catseye.app.engine.signals import SignalInstaller
from catseye.app.files.atomic import write_atomically
from catseye.app.files.documents import read_truth
from catseye.app.protocol.procedures import analysed_by, on_the_way
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
from catseye.app.service.scara.emulation import emulation_config
from catseye.app.store.reader import RunReader
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.layout import ModelName
from catseye.procedures.scara.bench import ScaraBench
from catseye.simulators.world.scara.truth import true_arm


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


async def measure(given: Demonstration) -> dict[str, Path]:
    """Start the emulators, run search, measurement and validation path, keep the truth.

    Returns:
        The run folders by procedure.

    Raises:
        DemoInterruptedError: a run did not complete.
        InterruptedRunError: Ctrl-C between two runs.
        TerminatedRunError: SIGTERM or SIGHUP between two runs.
    """
    return await interruptible(partial(_measure, given))


async def _measure(given: Demonstration, install_signals: SignalInstaller) -> dict[str, Path]:
    chosen = [(procedure, procedure.demo) for procedure in on_the_way() if procedure.demo is not None]
    async with emulated_bench(given, TEMPLATE) as loaded:
        runs = await run_each(given, loaded, chosen, install_signals)
    return dict(zip((procedure.name for procedure, _ in chosen), runs, strict=True))


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
    make_folder(folder)
