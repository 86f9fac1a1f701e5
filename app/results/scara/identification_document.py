"""What `identify --json` says of a result, whose file has the rest."""

from pathlib import Path
from typing import Any

from catseye.app.results.document import Document
from catseye.app.results.scara.budget_part import BudgetPart
from catseye.app.results.scara.result import Estimate, Fit, J4OrderPart, Result, TermEstimate


class IdentificationDocument(Document):
    """An identified SCARA.

    Attributes:
        result: its file.
        model: that was fitted.
        gauge: what fixes the direction of the base.
        extension: further terms of the model; null where there are none.
        budget: what contributes to the uncertainties; null where no budget was given.
        j4_orders: errors that follow J4's angle; null where they were not separated.
    """

    result: str
    model: str
    gauge: str
    link1_mm: Estimate
    link2_mm: Estimate
    fit: Fit
    extension: list[TermEstimate] | None
    budget: BudgetPart | None
    j4_orders: list[J4OrderPart] | None


def identification_document(result: Result, output: Path) -> dict[str, Any]:
    """Return what is said of a result that is written to a file."""
    said = set(IdentificationDocument.model_fields) - {"result"}
    return {"result": str(output), **result.model_dump(mode="json", include=said)}
