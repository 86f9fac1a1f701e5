"""Work on stored data as a stage of the day: what is asked before, and the words of its command."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from catseye.app.files.documents import is_file
from catseye.app.results.readiness.stages import CellStage
from catseye.app.tui.dialogs.form_dialog import Answers, Field
from catseye.app.tui.screens.working import typed_path

if TYPE_CHECKING:
    from catseye.app.cell.scara.uncertainty import ContributorEntry


def fields_of(stage: CellStage) -> Sequence[Field]:
    """Return what a person has to give."""
    return [Field(asked.name, asked.what, "", hint=asked.hint) for asked in stage.asks]


def fault_of(answers: Answers) -> str:
    """Return what is wrong with the answers, empty when nothing is: every one is a file that is read."""
    for text in answers.values():
        if not text:
            return "a file is needed"
        if not is_file(typed_path(text)):
            return f"there is no file {text}"
    return ""


def changes_text(answer: str) -> str:
    """Return what a command would change in the cell file, by its JSON answer."""
    from catseye.app.results.scara.measured_budget_document import MeasuredBudgetDocument

    found = MeasuredBudgetDocument.model_validate_json(answer)
    lines = [
        f"{each.after.name}: {_before(each.before)} → {each.after.stated}" for each in found.contributors
    ]
    return "\n".join([Path(found.cell).name, *lines, *found.reservations])


def _before(entry: "ContributorEntry | None") -> str:
    return "none" if entry is None else entry.stated


def words_of(stage: CellStage, answers: Answers) -> tuple[str | Path, ...]:
    """Return the words of a stage's command with what was answered."""
    given = {f"{{{name}}}": typed_path(text) for name, text in answers.items()}
    return tuple(given.get(word, word) for word in stage.words)
