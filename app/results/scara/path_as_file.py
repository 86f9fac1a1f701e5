"""The positions of a run of validation-path as a measured file, as whoever compares with files takes them."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from catseye.app.files.atomic import write_atomically
from catseye.app.results.scara.export import run_export
from catseye.app.store.reader import RunReader


@contextmanager
def path_as_file(reader: RunReader) -> Iterator[Path]:
    """Give what a run has measured as a CSV file of its name, which is gone afterwards.

    Raises:
        UsageError: the run has measured nothing that a file holds.
    """
    exported = run_export(reader)
    with TemporaryDirectory(prefix="catseye-path-") as scratch:
        measured = Path(scratch) / f"{reader.name}.csv"
        write_atomically(measured, exported.csv)
        yield measured
