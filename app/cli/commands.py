"""Every command of `catseye`, in the order of its help."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

_SCARA: Final = "catseye.app.cli.scara"
_RESOLUTION: Final = "catseye.app.cli.resolution"
_SERIAL_ARM: Final = "catseye.app.cli.serial_arm"


@dataclass(frozen=True)
class Command:
    """What is known of a command before it is imported.

    Attributes:
        summary: the first line of its own docstring.
        package: holds a module of the command's name, hyphens as underscores, which declares it.
    """

    summary: str
    package: str = "catseye.app.cli"


COMMANDS: Final[Mapping[str, Command]] = {
    "demo": Command("Do the whole job on emulated hardware over real sockets: measure, evaluate, report."),
    "init": Command(
        "Write a commented cell file: for a SCARA with the paper's reflectors, for resolution, or for a six-axis arm."
    ),
    "config": Command("Check and show cell files."),
    "schema": Command("Print the JSON schema of what a command writes for programs; alone, list the names."),
    "emulate": Command("Emulate every device of a cell file on its endpoints until Ctrl-C."),
    "doctor": Command(
        "Connect to each device of a cell file: who answers, its status, what is wrong and what to do."
    ),
    "reset-alarm": Command(
        "Show the alarm of the controller, and reset it once somebody has read it; nothing moves."
    ),
    "terminal": Command("Show the raw traffic of a device in hex and text, and send what is typed."),
    "procedures": Command(
        "List what can be run, with parameters, units and ranges; of a cell, what is needed and what comes next."
    ),
    "prompts": Command(
        "List the questions that a run of a procedure may ask, and how an answers file answers them."
    ),
    "run": Command(
        "Run a procedure headless. Ctrl-C: once holds, twice stops, three times aborts. This is no emergency stop."
    ),
    "engine": Command(
        "Run an engine of its own process: idle until a client starts a procedure, it outlives clients and terminal."
    ),
    "attach": Command("Join a run that is under way: watch it, or steer it. Ends with the run's exit code."),
    "tui": Command("Show the terminal user interface. It joins the engine that is running, or starts one."),
    "resume": Command(
        "Go on with a run that stopped, failed, was aborted or died; steps that are done are not repeated."
    ),
    "runs": Command("List the stored runs, oldest first."),
    "show": Command("Show a run's timeline: what, with which devices, what happened, how it ended."),
    "verify": Command("Check a stored run against its manifest and its own rules."),
    "identify": Command("Identify the arm from distances.", _SCARA),
    "budget": Command("Write what a run has measured of the error budget into its cell file.", _SCARA),
    "diagnose": Command(
        "Show what speaks against a fit: outliers, drift, lack of fit, cross-validation, richer models, node spacing."
    ),
    "compare": Command(
        "Compare two results of one arm, parameter by parameter, in combined standard uncertainties."
    ),
    "trend": Command("Show the results of a cell's arm over months, each against a baseline."),
    "predict": Command(
        "Predict where the arm really goes, with uncertainties; beyond the identified range it says nothing."
    ),
    "validate": Command("Compare a model with an independent measurement."),
    "compensate": Command(
        "Turn the model round: commands that bring the arm where it shall go, or a bidirectional table."
    ),
    "design": Command("Find where to put the reflectors and which commands to use.", _SCARA),
    "resolution": Command(
        "Find step errors, least increment steps and reversal errors in runs or recordings.", _RESOLUTION
    ),
    "resolution-model": Command(
        "Make look-up tables of step errors from results of motion resolution.", _RESOLUTION
    ),
    "predict-resolution": Command(
        "Predict the smallest steps of the tool at poses, from look-up tables of its joints.", _RESOLUTION
    ),
    "select-poses": Command("Choose the poses that identify a serial arm best.", _SERIAL_ARM),
    "calibrate": Command(
        "Identify the geometry and the compliances of a serial arm from measured poses: runs, tables, or both.",
        _SERIAL_ARM,
    ),
    "report": Command(
        "Write one self-contained HTML page about a run or a result, or about several results of motion resolution."
    ),
    "dossier": Command(
        "Join the day of a cell into one HTML page: a certificate of one page, then each stage."
    ),
    "export": Command("Write what a run has measured or what a result holds for other programs."),
}
"""By name."""
