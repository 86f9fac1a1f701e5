"""Radial error motions that a run has measured, in the error budget of its cell file: before and after."""

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from catseye.app.cell.hands import robot_is_emulated
from catseye.app.cell.load import LoadedCell, cell_fault_text
from catseye.app.cell.rewriting import CommentsLostError, rewritten
from catseye.app.cell.scara.uncertainty import ContributorEntry, Uncertainty
from catseye.app.errors import ConfigError, UsageError
from catseye.app.files.atomic import write_users_file
from catseye.app.files.documents import document_text, parse_toml, read_document
from catseye.app.results.model import Column, Origin, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import NOTHING
from catseye.app.results.runs.run_source import are_simulated, origin_of_run
from catseye.app.results.scara.found.error_motion import is_resolved, limit_um, reservations, results_of
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
        reservations: why they may be too small or less certain than they say.
        sha256: of the bytes of the file that they were made from.
        text: of the file with them; all else stays as it is.
    """

    path: Path
    run: str
    origin: Origin
    changes: tuple[MeasuredContributor, ...]
    reservations: tuple[Statement, ...]
    sha256: str
    text: str


def measured_budget(reader: RunReader, loaded: LoadedCell) -> MeasuredBudget:
    """Return what a run changes in the budget of its cell file; nothing is written.

    Raises:
        UsageError: the run has measured no error motion, or is another cell's.
        ConfigError: the file cannot be changed in place or was changed meanwhile, several lines of the budget stand
            for one axis, or another line has the name that one of them gets.
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
    changes = tuple(_changed(cell.uncertainty.contributor, row, reader.name, loaded.path) for row in found)
    return MeasuredBudget(
        path=loaded.path,
        run=reader.name,
        origin=origin_of_run(reader),
        changes=changes,
        reservations=tuple(reservations(reader, found)),
        sha256=loaded.sha256,
        text=_text(loaded, changes),
    )


def write_budget(budget: MeasuredBudget) -> None:
    """Write the cell file.

    Raises:
        ConfigError: somebody has changed it meanwhile; it stays as it is.
        StorageError: it cannot be written.
    """
    _unchanged(budget.path, budget.sha256)
    write_users_file(budget.path, budget.text)


def _unchanged(path: Path, sha256: str) -> bytes:
    """Return the bytes of a cell file that is still what was read of it."""
    raw = read_document(path)
    if hashlib.sha256(raw).hexdigest() != sha256:
        raise ConfigError(f"{path} was changed meanwhile and stays as it is: give the command again")
    return raw


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
        cell=str(budget.path),
        run=budget.run,
        written=written,
        contributors=contributors,
        reservations=[each.text for each in budget.reservations],
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
    # An amplitude that was measured is stated by its standard uncertainty, and a spectrum is relative to the former.
    left_out = {"distribution", "degrees_of_freedom", "spectrum"}
    kept = {key: value for key, value in kept.items() if key not in left_out}
    return MeasuredContributor(
        own[0] if own else None,
        ContributorEntry.model_validate({**kept, **_measured(row), "measured_by": run}),
    )


def _measured(row: Row) -> dict[str, float]:
    """Return value and degrees of freedom; where the motion is not resolved, what it is at most."""
    if not is_resolved(row):
        return {"value_um": _rounded(limit_um(row))}
    value = {"value_um": _rounded(number_of(row, "rms_um"))}
    if row["budget_dof"] is None:
        return value
    return {**value, "degrees_of_freedom": float(math.floor(number_of(row, "budget_dof")))}


def _rounded(value_um: float) -> float:
    """Return a value with three significant digits: a small one counts, too."""
    return float(f"{value_um:.3g}")


def _text(loaded: LoadedCell, changes: Sequence[MeasuredContributor]) -> str:
    """Return the file with the changed lines.

    A file without a list of contributors gets the whole list: a list that is there is the whole budget.
    """
    path = loaded.path
    text = document_text(_unchanged(path, loaded.sha256), path)
    document = parse_toml(text, str(path))
    section = document.get("uncertainty", {})
    listed = section.get("contributor") if isinstance(section, Mapping) else None
    tables = (
        listed if listed is not None else [_as_table(entry) for entry in loaded.cell.uncertainty.contributor]
    )
    after = {each.before.name: each.after for each in changes if each.before is not None}
    wanted = [_as_table(after[table["name"]]) if table["name"] in after else table for table in tables]
    wanted += [_as_table(each.after) for each in changes if each.before is None]
    _require_sound(path, wanted)
    try:
        return rewritten(text, {**document, "uncertainty": {"contributor": wanted}})
    except CommentsLostError as error:
        raise ConfigError(f"{path}: {error}; write each of its tables in one piece") from error


def _require_sound(path: Path, contributors: Sequence[Mapping[str, Any]]) -> None:
    """Refuse a budget that no cell file may have, before it is written."""
    try:
        Uncertainty.model_validate({"contributor": contributors})
    except ValidationError as error:
        faults = "; ".join(map(cell_fault_text, error.errors()))
        raise ConfigError(f"{path} cannot take what was measured: {faults}") from error


def _as_table(entry: ContributorEntry) -> dict[str, Any]:
    return entry.model_dump(mode="json", exclude_unset=True)
