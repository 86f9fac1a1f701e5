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
    "demo": Command(
        "Measure, evaluate and report on emulated hardware. The devices are emulated behind real sockets."
    ),
    "init": Command(
        "Write a commented cell file. It is a template for error maps, motion resolution or a six-axis arm."
    ),
    "config": Command("Check and show cell files."),
    "schema": Command("Print the JSON schema of a command's output. Without a name, list the names."),
    "emulate": Command("Emulate the devices of a cell file until Ctrl-C."),
    "doctor": Command(
        "Check the devices of a cell file. Shows which answer, their status, what is wrong and how to fix it."
    ),
    "reset-alarm": Command("Show the controller's alarm and reset it. Nothing moves."),
    "terminal": Command(
        "Show the raw traffic of a device and send to it. Traffic is shown in hex and as text."
    ),
    "procedures": Command(
        "List the procedures and their parameters. With --cell, also what each one needs and what comes next."
    ),
    "prompts": Command(
        "List the questions that a run may ask. Also says which answers an answers file may give."
    ),
    "run": Command(
        "Run a procedure. Ctrl-C holds, a second stops, a third aborts; it is not an emergency stop."
    ),
    "campaign": Command("Carry out the stages of a day or a night. Says of each stage whether it passed."),
    "engine": Command(
        "Start an engine for clients to use. It waits for a client to start a procedure, and outlives clients."
    ),
    "attach": Command("Watch or control a run under way. Ends with the run's exit code."),
    "tui": Command("Start the terminal user interface. It joins a running engine or starts one."),
    "resume": Command("Continue an interrupted run. Completed steps are not repeated."),
    "runs": Command("List the stored runs, oldest first; prune and keep them."),
    "show": Command("Show the history and the results of a run."),
    "verify": Command(
        "Check whether a stored run was changed. Compares it with its manifest and checks its consistency."
    ),
    "identify": Command("Identify links and error maps from distances.", _SCARA),
    "budget": Command(
        "Write measured error motions into the cell file. They replace values of the error budget.", _SCARA
    ),
    "diagnose": Command(
        "Check a fit. Outliers, drift, lack of fit, cross-validation, richer models, node spacing."
    ),
    "compare": Command(
        "Compare two results of one arm. Differences are also given in combined standard uncertainties."
    ),
    "trend": Command("Compare all results of an arm with a baseline."),
    "predict": Command(
        "Predict where the arm really goes. States uncertainties; commands beyond the identified range get no values."
    ),
    "validate": Command("Compare a model with an independent measurement."),
    "compensate": Command(
        "Correct commands or write compensation tables. The commands bring the arm to the desired positions."
    ),
    "design": Command(
        "Find the best places for the reflectors. Also chooses commands and estimates uncertainty and time.",
        _SCARA,
    ),
    "resolution": Command(
        "Determine least increment steps and reversal errors. The data are runs, or recordings of other programs.",
        _RESOLUTION,
    ),
    "resolution-model": Command(
        "Make look-up tables of step errors of joints. The data are results of catseye resolution.",
        _RESOLUTION,
    ),
    "predict-resolution": Command(
        "Predict the smallest steps of the tool. The data are look-up tables of the joints.", _RESOLUTION
    ),
    "select-poses": Command("Choose the best poses to calibrate a serial arm.", _SERIAL_ARM),
    "calibrate": Command(
        "Identify geometry and compliance of a serial arm. The data are runs, tables of measured poses, or both.",
        _SERIAL_ARM,
    ),
    "report": Command(
        "Write an HTML report of a run or a result. For motion resolution it may combine several results."
    ),
    "dossier": Command(
        "Write an HTML report of a cell's day. It begins with a one-page certificate; each stage follows."
    ),
    "export": Command("Export a run or a result to other programs."),
}
"""By name."""
