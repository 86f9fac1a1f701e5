"""What a run changes in the error budget of a cell file, for programs."""

from typing import Literal

from catseye.app.cell.scara.uncertainty import ContributorEntry
from catseye.app.results.uncertainty_part import ResultPart


class ChangedContributor(ResultPart):
    """A line of the budget; `before` is null where there was none."""

    before: ContributorEntry | None
    after: ContributorEntry


class MeasuredBudgetDocument(ResultPart):
    """The lines that a run has measured; `written` says that the cell file has them.

    `reservations` says why they may be too small or less certain than they say.
    """

    format: Literal["catseye-measured-budget/1"] = "catseye-measured-budget/1"
    cell: str
    run: str
    written: bool
    contributors: list[ChangedContributor]
    reservations: list[str]
