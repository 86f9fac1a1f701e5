"""Where a run comes from: the cell that it was made with, and whether its devices were emulated."""

from collections.abc import Sequence

from pydantic import ValidationError

from catseye.app.cell.model import Cell
from catseye.app.cell.section import RECORD
from catseye.app.errors import UsageError
from catseye.app.results.model import Origin
from catseye.app.results.origin import origin_now
from catseye.app.store.device_identity import device_identity
from catseye.app.store.reader import RunReader


def cell_of_run(reader: RunReader) -> Cell:
    """Return the cell that a run was made with, from the run's own record.

    Raises:
        UsageError: the run does not describe its cell.
    """
    try:
        return Cell.model_validate(reader.meta.get("configuration"), context=RECORD)
    except ValidationError as error:
        raise UsageError(f"{reader.path.name} does not hold the cell it was made with") from error


def are_simulated(readers: Sequence[RunReader]) -> bool | None:
    """Return whether a run was made on emulated devices, None without runs."""
    return any(bool(reader.meta.get("simulated")) for reader in readers) if readers else None


def interferometer_of(readers: Sequence[RunReader]) -> str | None:
    """Return model and serial number of the interferometer; None unless all runs state the same."""
    found = {device_identity(reader.meta, "interferometer") for reader in readers}
    return (found.pop() or None) if len(found) == 1 else None


def origin_of_run(reader: RunReader) -> Origin:
    """Return the origin of what is made of a run now."""
    return origin_now(simulated=bool(are_simulated([reader])), unverified=reader.unverified)
