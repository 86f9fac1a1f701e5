"""Chooses the poses of a calibration with `catseye select-poses`, and shows the index against their number."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.content import Content

from catseye.app.protocol.parameters import names_in
from catseye.app.results.model import Sign, Statement
from catseye.app.tui.dialogs.box_dialog import BoxDialog
from catseye.app.tui.dialogs.form_dialog import Answers, Field, FormDialog
from catseye.app.tui.screens.working import free_name, typed_path, why_not_written
from catseye.app.tui.session import Session
from catseye.app.tui.widgets.figure_view import Figures
from catseye.app.tui.widgets.report_content import statement_content
from catseye.app.tui.widgets.static_text import StaticText, lines
from catseye.app.tui.widgets.task_line import TaskLine

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.results.readiness.survey_document import ProcedureEntry

POSES: Final = "poses"
"""Parameter that takes the file of chosen poses."""

_COUNT: Final = "count"
_CANDIDATES: Final = "candidates"
_FILE: Final = "file"
_INDEX: Final = "index"
_INDICES: Final = ("O1", "O2", "O3", "O4", "O5")

_OPTIONS: Final = {
    "approach_deg": "--approach",
    "measured": "--measured",
    "targets_per_pose": "--targets-per-pose",
    "model": "--model",
    "seed": "--seed",
}
"""Of the command, by parameters of the procedure: the poses are to be measured as its form says."""

_TARGETS: Final = "targets"

Take = Callable[[str], None]


def takes_chosen_poses(procedure: "ProcedureEntry | None") -> bool:
    """Return whether a procedure chooses poses that identify an arm, or takes them from a file."""
    return procedure is not None and {POSES, _COUNT, _CANDIDATES} <= procedure.params.keys()


def choose_poses(cell: Path, session: Session, app: App[Any], typed: Mapping[str, str], take: Take) -> None:
    """Ask how many poses are wanted, choose them, and show what other numbers would be worth.

    Args:
        typed: parameters of the procedure that are not left at their defaults, without faults.
        take: called with the file, if the poses are to be used.
    """
    fields = [
        Field(_COUNT, "Poses", typed.get(_COUNT, "38"), hint="the paper: 38"),
        Field(_CANDIDATES, "Candidates", typed.get(_CANDIDATES, "5000"), hint="random poses to choose from"),
        Field(_INDEX, "Index", _INDICES[0], _INDICES, "observability; the paper: O1"),
        Field(_FILE, "File", str(free_name(cell.parent / "poses.csv"))),
    ]
    rules = {name: typed[name] for name in (*_OPTIONS, _TARGETS) if name in typed}
    said = ", ".join(f"{name} {text}" for name, text in rules.items())
    text = f"As the form says: {said}" if said else ""
    dialog = FormDialog("Choose the poses that identify the arm best", fields, text, fault=_fault)
    app.push_screen(dialog, partial(_begin, cell, session, app, _words(rules), take))


def _words(rules: Mapping[str, str]) -> list[str]:
    """Return what a form says, as options of the command."""
    words = [part for name, text in rules.items() if name in _OPTIONS for part in (_OPTIONS[name], text)]
    return words + [part for name in names_in(rules.get(_TARGETS, "")) for part in ("--target", name)]


def _begin(
    cell: Path, session: Session, app: App[Any], rules: list[str], take: Take, answers: Answers | None
) -> None:
    if answers is not None:
        app.push_screen(
            PoseChoice(cell, session, answers, rules),
            lambda used: take(str(typed_path(answers[_FILE]))) if used else None,
        )


def _fault(answers: Answers) -> str:
    """Return what is wrong with the answers; empty when nothing is."""
    count, candidates = (_whole(answers[key]) for key in (_COUNT, _CANDIDATES))
    if count is None or candidates is None:
        return "poses and candidates: give whole numbers above 0"
    if count >= candidates:
        return f"{count} poses cannot be chosen from {candidates} candidates: take more candidates"
    return why_not_written(answers[_FILE])


def _whole(text: str) -> int | None:
    return int(text) if text.isascii() and text.isdigit() and int(text) else None


class PoseChoice(BoxDialog[bool]):
    """Lets the command choose, and shows what it found. Esc cancels, and leaves the poses unused.

    Args:
        cell: cell file, whose arm, limits and instrument count.
        answers: how many poses, of how many candidates, by which index, into which file.
        rules: further options of the command.
    """

    DEFAULT_CSS = """
    PoseChoice > Vertical { width: 96; height: 92%; max-height: 34; }
    PoseChoice #found { height: auto; max-height: 6; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+s", "use", "use these poses", id="poses.use"),
        Binding("escape", "close", "cancel, close", id="poses.close"),
    ]

    def __init__(self, cell: Path, session: Session, answers: Answers, rules: Sequence[str]) -> None:
        super().__init__("Poses for a calibration")
        self._cell = cell
        self._session = session
        self._answers = answers
        self._rules = rules

    def body(self) -> ComposeResult:
        """What was found, its figure, and how far the command is."""
        yield StaticText(id="found")
        yield Figures()
        yield TaskLine(self._session.now_s)

    def on_mount(self) -> None:
        """Begin at once."""
        self.run_worker(self._choose(), group="choose", exclusive=True, exit_on_error=False)

    def check_action(self, action: str, _parameters: tuple[object, ...]) -> bool | None:
        """Offer the poses when they are there."""
        return action != "use" or self.has_class("chosen")

    def action_use(self) -> None:
        """Take the poses for the procedure."""
        self.dismiss(True)

    def action_close(self) -> None:
        """End the command, or leave the poses."""
        self.workers.cancel_group(self, "choose")
        self.dismiss(False)

    async def _choose(self) -> None:
        words = [part for key in (_COUNT, _CANDIDATES, _INDEX) for part in (f"--{key}", self._answers[key])]
        words += self._rules
        file, line = typed_path(self._answers[_FILE]), self.query_one(TaskLine)
        line.begin("choosing poses")
        try:
            with self._session.at_work("choosing poses"):
                done = await self._session.work.do(
                    "select-poses", "--cell", self._cell, *words, "-o", file, "--json", heard=line.hear
                )
        finally:
            line.end()
        if done.code:
            self._say(statement_content(Statement(Sign.BAD, done.fault)))
            return
        from catseye.app.results.serial_arm.selection_document import ADVICE, SelectionDocument

        found = done.document(SelectionDocument)
        said = (Statement(Sign.GOOD, found.text), Statement(Sign.NEUTRAL, f"{file} written. {ADVICE}"))
        self._say(lines(*map(statement_content, said)))
        self.query_one(Figures).show(found.figure())
        self.add_class("chosen")
        self.refresh_bindings()

    def _say(self, text: Content) -> None:
        self.query_one("#found", StaticText).set_text(text)
