"""What may be chosen at the start of a procedure, and how stages are marked."""

from typing import TYPE_CHECKING, Final

from catseye.app.tui.widgets.parameter_form import Schema

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.results.readiness.survey_document import ProcedureEntry

STAGE_SIGNS: Final = {"done": "✓", "next": "→", "later": "·", "left out": "–"}


def with_run_fields(procedure: "ProcedureEntry", speed: float, *, real: bool) -> Schema:
    """Return the parameters of a procedure and what else a start may choose.

    Args:
        speed: bench seconds in one real second, where nothing is typed.
        real: the devices are real: their time runs as it runs.
    """
    fields = dict(procedure.params)
    if procedure.needs_aim:
        fields["search"] = {
            "type": "string",
            "default": "auto",
            "description": "aim: auto takes the newest search of this cell, none the cell file, or a run's name",
        }
    if not real:
        fields["speed"] = {
            "type": "number",
            "default": speed,
            "minimum": 0.001,
            "maximum": 1e6,
            "description": "bench seconds in one real second, for emulators",
        }
    return fields
