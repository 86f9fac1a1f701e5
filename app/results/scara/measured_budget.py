"""Radial error motions that a run has measured, in the error budget of its cell file: before and after."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from catseye.app.cell.hands import robot_is_emulated
from catseye.app.cell.load import LoadedCell
from catseye.app.cell.rewriting import CommentsLostError, rewritten
from catseye.app.cell.scara.uncertainty import ContributorEntry
from catseye.app.errors import ConfigError, UsageError
from catseye.app.files.documents import parse_toml, read_text
from catseye.app.results.model import Column, Origin, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import EXPANDED, NOTHING
from catseye.app.results.runs.run_source import are_simulated, origin_of_run
from catseye.app.results.scara.found.error_motion import is_resolved, results_of
from catseye.app.results.scara.measured_budget_document import ChangedContributor, MeasuredBudgetDocument
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of


@dataclass(frozen=True)
class MeasuredContributor:
    """A line of the budget, as it was and as it is to be.

    Attributes:
        before: None where there was none.
        after: with what was measured.
    """

    before: ContributorEntry | None
    after: ContributorEntry


@dataclass(frozen=True)
class MeasuredBudget:
    """What a run changes in the budget of a cell file.

    Attributes:
        path: the cell file.
        run: name of the run.
        origin: of the run.
        changes: of its lines.
        text: of the file with them; all else stays as it is.
    """

    path: Path
    run: str
    origin: Origin
    changes: tuple[MeasuredContributor, ...]
    text: str


def measured_budget(reader: RunReader, loaded: LoadedCell) -> MeasuredBudget:
    """Return what a run changes in the budget of its cell file; nothing is written.

    Raises:
        UsageError: the run has measured no error motion, or is another cell's.
        ConfigError: the file cannot be changed in place, or several lines of the budget stand for one axis.
    """
    found, cell = results_of(reader), loaded.cell
    if not found:
        raise UsageError(
            f"{reader.name} has found no radial error motion: give a run of radial-error-motion that finished a joint"
        )
    if reader.meta.get("cell") != cell.name:
        raise UsageError(
            f"{reader.name} was measured on {reader.meta.get('cell')}, and {loaded.path} is {cell.name}"
        )
    if are_simulated([reader]) and not robot_is_emulated(cell):
        raise UsageError(
            f"{reader.name} was measured on an emulated bench: its values say nothing of the robot of {loaded.path}"
        )
    entries = list(cell.uncertainty.contributor)
    changes = tuple(_changed(entries, row, reader.name, loaded.path) for row in found)
    return MeasuredBudget(
        loaded.path, reader.name, origin_of_run(reader), changes, _text(loaded.path, entries, changes)
    )


def budget_report(budget: MeasuredBudget, *, written: bool) -> Report:
    """Return the lines before and after.

    Args:
        written: the file has them.
    """
    blocks = (_said(budget, written=written), _table(budget))
    return Report("Error budget", budget.origin, (section("budget", "Error budget", blocks, brief=True),))


def budget_document(budget: MeasuredBudget, *, written: bool) -> MeasuredBudgetDocument:
    """Return the same for programs."""
    contributors = [ChangedContributor(before=each.before, after=each.after) for each in budget.changes]
    return MeasuredBudgetDocument(
        cell=str(budget.path), run=budget.run, written=written, contributors=contributors
    )


def _table(budget: MeasuredBudget) -> Table:
    columns = (
        Column("contributor", "contributor"),
        Column("before", "before"),
        Column("before_by", "measured by"),
        Column("after", "after"),
        Column("degrees_of_freedom", "degrees of freedom"),
    )
    rows = tuple(
        (
            each.after.name,
            NOTHING if each.before is None else each.before.stated,
            NOTHING if each.before is None else each.before.measured_by or "nobody",
            each.after.stated,
            NOTHING if each.after.degrees_of_freedom is None else f"{each.after.degrees_of_freedom:g}",
        )
        for each in budget.changes
    )
    return Table(
        "budget",
        f"Error budget with run {budget.run}, as {budget.path.name} states it: standard uncertainties u",
        columns,
        rows,
    )


def _said(budget: MeasuredBudget, *, written: bool) -> Statement:
    texts = ", ".join(_change_text(each) for each in budget.changes)
    if written:
        text = f"{budget.path} states now: {texts}. Measurements from now on are identified with it."
        return Statement(Sign.GOOD, text)
    return Statement(Sign.NEUTRAL, f"{budget.path} would state: {texts}.")


def _change_text(change: MeasuredContributor) -> str:
    before = "" if change.before is None else f", was {change.before.stated}"
    return f"{change.after.name} {change.after.stated}{before}"


def _changed(entries: Sequence[ContributorEntry], row: Row, run: str, path: Path) -> MeasuredContributor:
    axis = str(row["joint"]).lower()
    own = [entry for entry in entries if entry.kind == "radial" and entry.axis == axis]
    if len(own) > 1:
        raise ConfigError(
            f"{path}: several contributors of kind radial stand for {axis}: leave one, which takes what was measured"
        )
    stated: dict[str, Any] = {
        "name": f"radial error motion of {row['joint']}",
        "kind": "radial",
        "axis": axis,
    }
    kept = own[0].model_dump(exclude_unset=True) if own else {**stated, "correlation": "axis-angle"}
    # An amplitude that was measured is stated by its standard uncertainty.
    kept = {key: value for key, value in kept.items() if key not in {"distribution", "degrees_of_freedom"}}
    return MeasuredContributor(
        own[0] if own else None,
        ContributorEntry.model_validate({**kept, **_measured(row), "measured_by": run}),
    )


def _measured(row: Row) -> dict[str, float]:
    """Return value and degrees of freedom; where the motion is not resolved, the limit below which it is."""
    if not is_resolved(row):
        return {"value_um": _rounded(EXPANDED * number_of(row, "u_rms_um"))}
    value = {"value_um": _rounded(number_of(row, "rms_um"))}
    if row["budget_dof"] is None:
        return value
    return {**value, "degrees_of_freedom": float(math.floor(number_of(row, "budget_dof")))}


def _rounded(value_um: float) -> float:
    return round(value_um, 2)


def _text(path: Path, entries: Sequence[ContributorEntry], changes: Sequence[MeasuredContributor]) -> str:
    """Return the file with the changed lines.

    A file without a list of contributors gets the whole list: a list that is there is the whole budget.
    """
    text = read_text(path)
    document = parse_toml(text, str(path))
    section = document.get("uncertainty", {})
    listed = section.get("contributor") if isinstance(section, Mapping) else None
    tables = listed if listed is not None else [_as_table(entry) for entry in entries]
    after = {each.before.name: each.after for each in changes if each.before is not None}
    wanted = [_as_table(after[table["name"]]) if table["name"] in after else table for table in tables]
    wanted += [_as_table(each.after) for each in changes if each.before is None]
    try:
        return rewritten(text, {**document, "uncertainty": {"contributor": wanted}})
    except CommentsLostError as error:
        raise ConfigError(f"{path}: {error}; write each of its tables in one piece") from error


def _as_table(entry: ContributorEntry) -> dict[str, Any]:
    return entry.model_dump(mode="json", exclude_unset=True)
