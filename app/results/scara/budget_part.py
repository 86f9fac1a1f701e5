"""The error budget as a document: what a points table carries along, and what a result says that it stands on."""

from typing import Final, Literal, Self

from catseye.app.cell.scara.uncertainty import ContributorEntry
from catseye.app.results.uncertainty_part import ResultPart
from catseye.calibration.scara.budget import Budget

BUDGET_KIND: Final = "catseye-budget"
"""What a budget is called among the documents that a table carries."""

ORIGIN_KIND: Final = "catseye-origin"
"""What the mark of a table is called that says where it comes from, budget or not."""

BudgetFormat = Literal["catseye-budget/1"]

CorrectedBy = Literal["program", "instrument"]
"""Who has corrected the distances for the air."""

BudgetSource = Literal["run", "table", "cell", "none"]

SigmaRole = Literal["absent", "white", "implied", "total"]
"""What the column sigma_mm of a table is: not there; what differs from reading to reading; the same as the budget's
contributors per reading; all contributors together, as earlier versions exported it."""


class TableBudget(ResultPart):
    """What a points table carries along.

    `sha256` is of the document itself and of the rows (`catseye.app.results.scara.table_budget`). `simulated` and
    `unverified` are those of the run, as in a result's provenance.
    """

    format: BudgetFormat
    source: str
    corrected_by: CorrectedBy | None = None
    simulated: bool | None = None
    unverified: list[str] | None = None
    contributor: list[ContributorEntry]
    sha256: str


class TableOrigin(ResultPart):
    """Where a points table comes from, beside its budget: whoever takes the budget out leaves this.

    `budget` is the sum of the budget that the table was written with.
    """

    simulated: bool | None = None
    unverified: list[str] | None = None
    budget: str


class BudgetPart(ResultPart):
    """What the uncertainties of a result stand on: whose budget, and what the column sigma_mm was taken for."""

    format: BudgetFormat = "catseye-budget/1"
    source: BudgetSource
    name: str
    sigma_mm: SigmaRole = "absent"
    corrected_by: CorrectedBy | None = None
    contributor: list[ContributorEntry]

    def learnt(self, used: Budget | None) -> Self:
        """Return it with the spectra that an identification has found; `used` is the budget that it returned."""
        if used is None:
            return self
        found = iter(used.systematic)
        entries = [
            entry
            if entry.correlation == "reading"
            else entry.model_copy(update={"spectrum": next(found).spectrum})
            for entry in self.contributor
        ]
        return self.model_copy(update={"contributor": entries})

    @property
    def everything(self) -> Budget | None:
        """All contributors; None for no budget."""
        if self.source == "none":
            return None
        return Budget(tuple(entry.contributor() for entry in self.contributor))

    @property
    def budget(self) -> Budget | None:
        """Contributors that were counted: beside a white sigma_mm those that distances share; None for no budget."""
        everything = self.everything
        if everything is None or self.sigma_mm != "white":
            return everything
        return Budget(everything.systematic)
