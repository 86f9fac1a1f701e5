"""Which error budget counts for distances: a run's, the table's own, the cell's, or none."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

from catseye.app.cell.scara.uncertainty import PAPER_WAVELENGTH_PPM, ContributorEntry, Uncertainty, table_2
from catseye.app.errors import UsageError
from catseye.app.results.model import Origin
from catseye.app.results.origin import origin_now
from catseye.app.results.runs.run_source import are_simulated, cell_of_run
from catseye.app.results.scara.budget_part import BudgetPart, CorrectedBy, SigmaRole
from catseye.app.results.scara.table_budget import SeenTable
from catseye.app.store.reader import RunReader
from catseye.calibration.scara.budget import Budget
from catseye.procedures.kit.columns import Columns

BudgetChoice = Literal["table", "cell", "none"]

_SAME: Final = 1e-9
"""A CSV file keeps numbers exactly."""


@dataclass(frozen=True)
class StatedBudget:
    """The budget that counts.

    Attributes:
        part: what a result says about it.
        unverified: what speaks against a table, or against the run that it was exported from.
        simulated: emulated devices have measured the distances; None where nothing says so.
    """

    part: BudgetPart
    unverified: tuple[str, ...] = ()
    simulated: bool | None = None

    @property
    def budget(self) -> Budget | None:
        """Contributors for a solver; None for what the distances state alone."""
        return self.part.budget

    @property
    def origin(self) -> Origin:
        """Where a report on the distances comes from."""
        return origin_now(simulated=bool(self.simulated), unverified=self.unverified)

    @property
    def counts_sigma(self) -> bool:
        """The column sigma_mm counts, where there is one."""
        return self.part.sigma_mm == "white"

    def counted_columns(self, points: Columns) -> Columns:
        """Return distances without uncertainties that do not count."""
        if self.counts_sigma or "sigma_mm" not in points:
            return points
        return replace(points, values={key: one for key, one in points.values.items() if key != "sigma_mm"})


def budget_of_runs(readers: Sequence[RunReader], choice: BudgetChoice | None = None) -> StatedBudget:
    """Return the budget of runs: that of the first one's cell.

    Args:
        choice: "none" leaves it; a run's own budget is that of its cell.
    """
    reader = readers[0]
    return StatedBudget(
        BudgetPart(
            source="none" if choice == "none" else "run",
            name=reader.path.name,
            corrected_by=corrected_by(reader),
            contributor=[] if choice == "none" else cell_of_run(reader).uncertainty.contributor,
        ),
        tuple(text for one in readers for text in one.unverified),
        are_simulated(readers),
    )


def other_budgets(readers: Sequence[RunReader]) -> list[str]:
    """Return which runs state another budget than the first one, whose budget counts for all."""
    first = cell_of_run(readers[0]).uncertainty
    return [
        f"{reader.path.name} states another error budget than {readers[0].path.name}, whose budget counts for all"
        for reader in readers[1:]
        if cell_of_run(reader).uncertainty != first
    ]


def budget_of_table(
    seen: SeenTable,
    stated: Uncertainty,
    cell_file: str,
    choice: BudgetChoice | None = None,
    *,
    unverified: bool = False,
) -> StatedBudget:
    """Return the budget of a points file: its own, else its cell's.

    Args:
        seen: the whole file.
        stated: of the cell file.
        choice: what is asked for; None for the table's own, else the cell's.
        unverified: take a table with its own budget that was changed since.

    Raises:
        UsageError: its own is asked for and it has none, or it was changed or taken out.
    """
    own, role = seen.own, _role_of_sigma(seen, stated)
    source, name, entries = "none", seen.file.name, list[ContributorEntry]()
    changes: tuple[str, ...] = ()
    if seen.lost_budget and choice is None:
        changes = _changes(seen, unverified=unverified)
    if choice == "none":
        role = "white" if seen.with_sigma else "absent"
    elif own is not None and choice != "cell":
        source, entries, changes = "table", own.contributor, _changes(seen, unverified=unverified)
    elif choice == "table":
        raise UsageError(
            f"{seen.file}: carries no error budget of its own: use --budget cell, --budget none, or a table that "
            "catseye export wrote"
        )
    else:
        source, name, entries = "cell", cell_file, stated.contributor
    air = None if own is None else own.corrected_by
    part = BudgetPart(source=source, name=name, sigma_mm=role, corrected_by=air, contributor=entries)
    return StatedBudget(part, (*seen.unverified, *changes), seen.simulated)


def corrected_by(reader: RunReader) -> CorrectedBy | None:
    """Return who corrected the distances of a run for the air; None for a run of an early version."""
    fact = reader.meta.get("compensation")
    match fact.get("by") if isinstance(fact, dict) else None:
        case "program":
            return "program"
        case "instrument":
            return "instrument"
    return None


def _role_of_sigma(seen: SeenTable, stated: Uncertainty) -> SigmaRole:
    if not seen.with_sigma:
        return "absent"
    if seen.own is not None:
        states_white = any(entry.correlation == "reading" for entry in seen.own.contributor)
        return "implied" if seen.intact and states_white else "white"
    one_mm = seen.one_sigma_mm
    # Export of earlier versions wrote one figure for everything: of the cell's budget, by default the paper's.
    paper = Uncertainty(contributor=table_2(wavelength_ppm=PAPER_WAVELENGTH_PPM))
    totals = (1e-3 * known.distance_um for known in (stated, paper))
    known = one_mm is not None and any(math.isclose(one_mm, total, rel_tol=_SAME) for total in totals)
    return "total" if known else "white"


def _changes(seen: SeenTable, *, unverified: bool) -> tuple[str, ...]:
    """Return what speaks against a table, nothing if it is as it was written.

    Raises:
        UsageError: it was changed, and is not to be taken as it is.
    """
    if seen.intact:
        return ()
    done = (
        "its error budget was taken out" if seen.lost_budget else "its rows or its error budget were changed"
    )
    text = f"{seen.file.name}: {done} after they were written together"
    if unverified:
        return (text,)
    raise UsageError(
        f"{text}: export it again, leave its budget with --budget cell or --budget none, or identify it as it is "
        "with --unverified"
    )
