"""The command of a stage, as the job gives it."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from catseye.app.campaign.load import LoadedCampaign
from catseye.app.campaign.model import StageEntry
from catseye.app.errors import UsageError
from catseye.app.results.readiness.stages import NO_RESULT, CellStage

_OUTPUT: Final = "-o"
_JSON: Final = "--json"
RUN: Final = "run"
"""Begins a new run."""

_RESUME: Final = "resume"
_DATA_COMMANDS: Final = frozenset(
    {
        "budget",
        "calibrate",
        "compare",
        "compensate",
        "diagnose",
        "dossier",
        "export",
        "identify",
        "predict",
        "predict-resolution",
        "report",
        "resolution",
        "resolution-model",
        "show",
        "trend",
        "validate",
        "verify",
    }
)
"""Commands on stored data: nothing moves."""

_PLACEHOLDER: Final = re.compile(r"\{([^{}]*)\}")

_OPTION: Final = re.compile(r"--[^=]*|-[A-Za-z]")
"""A long option without its value, or a short one: `-5` is a number."""

KNOWN: Final = frozenset({"cell", "folder", "job", "runs", "result"})
"""What the words of a stage's own command may name in braces."""

Options = Callable[[str], frozenset[str]]


@dataclass(frozen=True)
class Driving:
    """How the runs of a job are driven; see `catseye.app.cli.hosting.DriveOptions`."""

    arm: str | None = None
    speed: float | None = None
    waive_walk: str | None = None
    answers: Path | None = None
    metrics: Path | None = None


@dataclass(frozen=True)
class Wording:
    """What the words of every stage of a job are made of.

    Attributes:
        loaded: the campaign.
        job: its id.
        folder: of the job.
        driving: how its runs are driven.
        options: returns the options of a command, with their dashes.
        known: what the words of a stage's own command may name in braces.
    """

    loaded: LoadedCampaign
    job: str
    folder: Path
    driving: Driving
    options: Options
    known: Mapping[str, str]

    def of_procedure(self, entry: StageEntry, stage: CellStage, *, anew: bool = False) -> tuple[str, ...]:
        """Return what runs a procedure, or goes on with its interrupted run.

        Args:
            anew: it does not go on.
        """
        words = list(stage.words)
        if anew and words[0] == _RESUME:
            # After the run's name both take the same.
            words[:2] = (RUN, entry.name, "--cell", self.known["cell"])
        if words[0] == RUN:
            words += ["--job", self.job]
            for name, value in entry.params.items():
                words += ["--param", f"{name}={self.loaded.text(value)}"]
        given = {
            "--answers": self.driving.answers,
            "--arm": self.driving.arm,
            "--waive-walk": self.driving.waive_walk,
            "--speed": self.driving.speed,
            "--metrics": self.driving.metrics,
        }
        for option, text in given.items():
            words += [] if text is None else [option, str(text)]
        return (*words, _JSON)

    def of_data(self, entry: StageEntry, stage: CellStage) -> tuple[str, ...]:
        """Return what works on the stored data of a stage."""
        asked = {f"{{{name}}}": str(self.loaded.file(path)) for name, path in entry.files.items()}
        words = [asked.get(word, word) for word in stage.words]
        return self._with_json((*self._own_output(words, stage), *options_of(self.loaded, entry)))

    def of_own(self, entry: StageEntry, results: tuple[str, ...]) -> tuple[str, ...] | None:
        """Return the words of a stage's own command; None while something that it names is not there.

        Args:
            results: that the way has led to so far.
        """
        known = {**self.known, **({"result": results[-1]} if results else {})}
        words = []
        for word in entry.command:
            if any(name not in known for name in _PLACEHOLDER.findall(word)):
                return None
            words.append(_PLACEHOLDER.sub(lambda found: known[found[1]], word))
        first = (words[0], *(self.loaded.text(word) for word in words[1:]))
        return self._with_json(first)

    def _own_output(self, words: list[str], stage: CellStage) -> Iterator[str]:
        """Yield the words; what would be written over by every job goes into its folder."""
        for before, word in zip(["", *words], words, strict=False):
            own = before == _OUTPUT and not any(run.rpartition("_")[2] in word for run in stage.runs)
            yield str(self.folder / Path(word).name) if own else word

    def _with_json(self, words: tuple[str, ...]) -> tuple[str, ...]:
        return (*words, _JSON) if _JSON in self.options(words[0]) and _JSON not in words else words


def options_of(loaded: LoadedCampaign, entry: StageEntry) -> tuple[str, ...]:
    """Return the options that a campaign gives a command on stored data."""
    words: list[str] = []
    for name, value in entry.options.items():
        option = option_of(name)
        if isinstance(value, bool):
            words += [option] if value else []
            continue
        for each in value if isinstance(value, list) else [value]:
            words += [option, loaded.text(each)]
    return tuple(words)


def option_of(name: str) -> str:
    """Return an option as the command line has it."""
    return f"--{name.replace('_', '-')}"


def lacks_earlier(stage: CellStage) -> bool:
    """Return whether work on stored data waits for a run or a result."""
    return not stage.procedure and (NO_RESULT in stage.words or not stage.runs)


def require_data_command(entry: StageEntry, path: Path, options: Options) -> None:
    """Check that a stage's own command is one on stored data, and that everything in its words is known.

    Raises:
        UsageError: it is another one, or has something unknown in it.
    """
    where = f"{path}: stage {entry.name}:"
    if entry.command[0] not in _DATA_COMMANDS:
        raise UsageError(
            f"{where} {entry.command[0]!r} is no command on stored data; there are "
            f"{', '.join(sorted(_DATA_COMMANDS))}. What moves the arm is a procedure: give the stage its name"
        )
    named = [name for word in entry.command for name in _PLACEHOLDER.findall(word)]
    if unknown := [name for name in named if name not in KNOWN]:
        braced = ", ".join(f"{{{name}}}" for name in sorted(KNOWN))
        raise UsageError(f"{where} nothing is known as {{{unknown[0]}}}; its words may name {braced}")
    given = (_OPTION.match(word) for word in entry.command[1:])
    require_options(where, entry.command[0], (found[0] for found in given if found), options)


def require_options(where: str, command: str, given: Iterable[str], options: Options) -> None:
    """Check that a command has the options that it is given.

    Args:
        where: begins the text of the error.
        given: options with their dashes.

    Raises:
        UsageError: it has not.
    """
    known = options(command)
    for option in given:
        if option not in known:
            names = ", ".join(sorted(each for each in known if each.startswith("-")))
            raise UsageError(f"{where} {command} has no option {option}; it has {names}")
