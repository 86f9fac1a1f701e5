"""The error budget that travels with a points table, and the seal that holds both together."""

import hashlib
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import ValidationError

from catseye.app.errors import UsageError
from catseye.app.files.documents import parse_json
from catseye.app.results.scara.budget_part import BUDGET_KIND, ORIGIN_KIND, TableBudget, TableOrigin
from catseye.app.results.scara.points import POINTS
from catseye.procedures.kit.columns import Columns

_Document = TypeVar("_Document", TableBudget, TableOrigin)

_NUMBERS = tuple(column.name for column in POINTS.forms[0] if column.kind != "name")


def documents_of(points: Columns, budget: TableBudget) -> dict[str, dict[str, Any]]:
    """Return what a table of distances carries along: a budget, sealed with the rows, and the mark of its origin.

    Args:
        points: all rows, with all columns that a points file may have.
        budget: what it says; its sum does not count.
    """
    unsealed = budget.model_dump(mode="json", exclude_none=True)
    seal = _Seal(unsealed)
    seal.add(points)
    sha256 = seal.hexdigest()
    origin = _origin_of(budget.model_copy(update={"sha256": sha256}))
    return {
        BUDGET_KIND: {**unsealed, "sha256": sha256},
        ORIGIN_KIND: origin.model_dump(mode="json", exclude_none=True),
    }


class _Seal:
    """SHA-256 of a budget and of the rows that it belongs to, whatever kind of file they stand in.

    The document counts as JSON with sorted keys; of a row the name of the reflector and 64-bit floats.
    """

    def __init__(self, document: Mapping[str, Any]) -> None:
        sealed = {key: value for key, value in document.items() if key != "sha256"}
        self._hash = hashlib.sha256(json.dumps(sealed, sort_keys=True).encode())

    def add(self, block: Columns) -> None:
        """Add rows below those that were added before."""
        own = [hashlib.sha256(name.encode()).digest()[:8] for name in block.names]
        numbers = block.stacked([name for name in _NUMBERS if name in block])
        rows = np.empty(len(block), dtype=[("reflector", "S8"), ("numbers", "<f8", numbers.shape[1:])])
        rows["reflector"] = np.array(own, dtype="S8")[block["reflector"].astype(np.int64)]
        rows["numbers"] = numbers + 0.0  # makes one zero of both
        self._hash.update(rows.tobytes())

    def hexdigest(self) -> str:
        """Return the sum of everything that was added."""
        return self._hash.hexdigest()


class SeenTable:
    """What a points file shows of its uncertainties while it is read, block by block.

    Args:
        file: for complaints.

    Attributes:
        own: the budget that it carries; None for none.
        origin: where it says that it comes from; None for tables of other programs and of early versions.
    """

    def __init__(self, file: Path) -> None:
        self.file = file
        self.own: TableBudget | None = None
        self.origin: TableOrigin | None = None
        self._seal: _Seal | None = None
        self._least, self._most = math.inf, -math.inf

    def see(self, block: Columns) -> None:
        """Look at rows below those that were seen before.

        Raises:
            UsageError: the table carries a budget or a mark of its origin that cannot be read.
        """
        mark = block.attached.get(ORIGIN_KIND)
        if mark is not None and self.origin is None:
            self.origin = _valid(self.file, ORIGIN_KIND, TableOrigin, mark)
        text = block.attached.get(BUDGET_KIND)
        if text is not None:
            if self._seal is None:
                self.own, self._seal = _read(self.file, text)
            self._seal.add(block)
        sigma_mm = block.get("sigma_mm")
        if sigma_mm is not None:
            self._least = min(self._least, float(sigma_mm.min(initial=math.inf)))
            self._most = max(self._most, float(sigma_mm.max(initial=-math.inf)))

    @property
    def intact(self) -> bool:
        """Budget, origin and rows are those that were written together."""
        if self.own is None or self._seal is None:
            return False
        marked = self.origin is None or self.origin == _origin_of(self.own)
        return marked and self._seal.hexdigest() == self.own.sha256

    @property
    def lost_budget(self) -> bool:
        """It was written with a budget and has none."""
        return self.own is None and self.origin is not None

    @property
    def simulated(self) -> bool | None:
        """Emulated devices have measured the distances, as either mark says; None where nothing says so."""
        said = [one.simulated for one in (self.own, self.origin) if one is not None]
        known = [one for one in said if one is not None]
        return any(known) if known else None

    @property
    def unverified(self) -> tuple[str, ...]:
        """What speaks against the run that it was exported from, as either mark says."""
        marks = [one.unverified or [] for one in (self.own, self.origin) if one is not None]
        return tuple(dict.fromkeys(text for texts in marks for text in texts))

    @property
    def with_sigma(self) -> bool:
        """The rows state uncertainties of their own."""
        return self._most >= self._least

    @property
    def one_sigma_mm(self) -> float | None:
        """The standard uncertainty that all rows state, mm; None where they differ or state none."""
        return self._most if self._most == self._least else None


def _read(file: Path, text: str) -> tuple[TableBudget, _Seal]:
    document = parse_json(text, f"{file}: {BUDGET_KIND}")
    form = document.get("format") if isinstance(document, dict) else None
    if isinstance(form, str) and form.startswith(f"{BUDGET_KIND}/") and form != f"{BUDGET_KIND}/1":
        raise UsageError(
            f"{file}: carries an error budget of format {form}; this version reads {BUDGET_KIND}/1: update catseye, "
            "or leave the budget with --budget cell or none and without its comment line"
        )
    return _valid(file, BUDGET_KIND, TableBudget, text), _Seal(document)


def _origin_of(budget: TableBudget) -> TableOrigin:
    return TableOrigin(simulated=budget.simulated, unverified=budget.unverified, budget=budget.sha256)


def _valid(file: Path, kind: str, model: type[_Document], text: str) -> _Document:
    try:
        return model.model_validate_json(text)
    except ValidationError as error:
        fault = error.errors()[0]
        place = ".".join(str(part) for part in fault["loc"]) or "document"
        what = "an error budget" if kind == BUDGET_KIND else "a mark of its origin"
        raise UsageError(
            f"{file}: carries {what} that cannot be read: {place}: {fault['msg']}; export the table again, "
            f"or take the {kind} line out of it"
        ) from error
