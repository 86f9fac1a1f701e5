"""Every command of `catseye`, in the order of its help."""

from collections.abc import Mapping
from typing import Final

COMMANDS: Final[Mapping[str, str]] = {
    "demo": (
        "Do the whole job on emulated hardware over real sockets: search, measure, identify, validate, report."
    ),
    "init": "Write a commented cell file for an RH-3FRH5515 with the paper's reflectors and commands.",
    "config": "Check and show cell files.",
    "emulate": "Emulate every device of a cell file on its endpoints until Ctrl-C.",
    "doctor": "Connect to each device of a cell file: who answers, its status, what is wrong and what to do.",
    "terminal": "Show the raw traffic of a device in hex and text, and send what is typed.",
    "procedures": (
        "List what can be run, with parameters, units and ranges; of a cell, what is needed and what comes next."
    ),
    "run": (
        "Run a procedure headless. Ctrl-C: once holds, twice stops, three times aborts. This is no emergency stop."
    ),
    "engine": (
        "Run an engine of its own process: idle until a client starts a procedure, it outlives clients and terminal."
    ),
    "attach": "Join a run that is under way: watch it, or steer it. Ends with the run's exit code.",
    "tui": "Show the terminal user interface. It joins the engine that is running, or starts one.",
    "resume": "Go on with a run that stopped, failed, was aborted or died; steps that are done are not repeated.",
    "runs": "List the stored runs, oldest first.",
    "show": "Show a run's story: what, with which devices, what happened, how it ended.",
    "verify": "Check a stored run against its manifest and its own rules.",
    "identify": "Identify the arm from distances.",
    "diagnose": (
        "Show what speaks against a fit: outliers, drift, lack of fit, cross-validation, richer models, node spacing."
    ),
    "compare": (
        "Compare two results of one arm: links, error maps and reflectors, in combined standard uncertainties."
    ),
    "predict": (
        "Predict where the arm really goes, with uncertainties; beyond the identified range it says nothing."
    ),
    "validate": "Compare a model with an independent measurement.",
    "compensate": "Turn the model round: commands that bring the arm where it shall go, or a bidirectional table.",
    "design": "Find where to put the reflectors and which commands to use.",
    "report": "Write one self-contained HTML page about a run or a result.",
    "export": "Write what a run has measured or what a result holds for other programs.",
}
"""Name and summary: the first line of the command's own docstring. catseye.app.cli.NAME declares it."""
