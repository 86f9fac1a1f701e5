"""One procedure on a terminal: what it does, its set-up, an example, its parameters."""

import textwrap
from typing import TYPE_CHECKING, Final

from catseye.app.render.text import report_text
from catseye.app.results.readiness.survey_report import procedures_report

if TYPE_CHECKING:
    # Most commands list procedures without it.
    from catseye.app.results.readiness.survey_document import ProcedureEntry, SurveyDocument

_WIDTH: Final = 78


def procedure_text(survey: "SurveyDocument", entry: "ProcedureEntry") -> str:
    """Return everything about a procedure.

    Args:
        survey: holds the procedure; what a cell has for it is shown where one was asked.
    """
    parts = [
        textwrap.fill(entry.about, _WIDTH),
        textwrap.indent(entry.sketch, "  "),
        f"Example: {entry.example}",
        report_text(procedures_report(survey.model_copy(update={"procedures": (entry,)}))),
    ]
    return "\n\n".join(part for part in parts if part)
