"""A result of motion resolution in rows and sentences, as the screen Results shows it; no widget in here."""

from pathlib import Path

from catseye.app.protocol.banners import SIMULATION
from catseye.app.results.numbers import counted
from catseye.app.results.resolution.result import ResolutionResult
from catseye.app.results.result_files import ResultFile
from catseye.app.tui.work import command_line


def resolution_row(file: ResultFile[ResolutionResult]) -> list[str]:
    """Return what the row of a file says: name, kind, tests, nothing, simulated, time."""
    when = f"{file.changed_utc:%m-%d %H:%M}"
    if file.result is None:
        return [file.path.name, "! no result", "", "", "", when]
    tests = counted(len(file.result.tests), "test")
    simulated = {True: "SIM", False: "", None: "?"}[_simulated(file.result)]
    return [file.path.name, "resolution", f"{tests:>10}", "", f" {simulated}", when]


def resolution_heading(file: ResultFile[ResolutionResult]) -> str:
    """Return which result is shown."""
    result = file.result
    if result is None:
        return f"{file.path.name}: cannot be read"
    simulated = {True: SIMULATION, False: "", None: "simulated or not: not known"}[_simulated(result)]
    parts = [file.path.name, result.arm, counted(len(result.tests), "test"), simulated]
    return " · ".join(part for part in parts if part)


def resolution_commands(file: Path) -> str:
    """Return the commands that go on from a result, with the names that the user has to give."""
    each = (
        (
            "look-up tables of the joints, from this and further results",
            ("resolution-model", str(file), "-o", "tables.csv"),
        ),
        (
            "Cartesian least steps at poses of the arm",
            (
                "predict-resolution",
                "tables.csv",
                "--arm",
                "ARM",
                "--poses",
                "POSES.csv",
                "-o",
                "predicted.json",
            ),
        ),
    )
    return "\n\n".join(f"{what}\n  {command_line(words)}" for what, words in each)


def _simulated(result: ResolutionResult) -> bool | None:
    return None if result.provenance is None else result.provenance.simulated
