"""The figure that stands for a finished stage: what a run has found, what a result is worth or leaves on a run."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from catseye.app.errors import CatseyeError, UsageError
from catseye.app.files.csv_lines import is_comment, lines_of
from catseye.app.results.dossier.validated import worth_of_validation
from catseye.app.results.found import found_sections
from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import EXPANDED, counted
from catseye.app.results.readiness.headline import Headline, Headlines, Written
from catseye.app.results.resolution.naming import with_unit
from catseye.app.results.resolution.recorded_runs import holds_tests, tests_recorded
from catseye.app.results.resolution.report_files import is_of_resolution
from catseye.app.results.resolution.result import AnyTest, read_resolution
from catseye.app.results.scara.result import read_result
from catseye.app.results.scara.values import largest_map_u_mdeg
from catseye.app.results.serial_arm.result import is_of_serial_arm, read_serial_arm
from catseye.app.store.reader import Accept, RunReader
from catseye.calibration.core.errors import CalibrationError

_UNUSABLE: Final = (CatseyeError, CalibrationError, LookupError, TypeError, ValueError)
_HOLDS: Final = frozenset({Sign.GOOD, Sign.NEUTRAL})
"""What nobody judges was reached as far as it was wanted."""


def headline_of_run(path: Path) -> Headline | None:
    """Return what a run has found; None of a run from which something is computed first."""
    try:
        reader = RunReader(path, Accept.UNCHECKED)
        if holds_tests(reader):
            # Evaluating recordings takes its time, and has a stage of its own.
            return Headline(f"{counted(tests_recorded(reader), 'test')} recorded")
        sections = found_sections(reader)
    except _UNUSABLE:
        # Another version may have stored it, or somebody has changed it: the run itself counts all the same.
        return None
    said = (block for one in sections for block in one.blocks if isinstance(block, Statement) and block.short)
    first = next(said, None)
    return None if first is None else Headline(first.short, first.sign in _HOLDS)


def headline_of_result(path: Path) -> Headline | None:
    """Return what a result is worth; None of a file that cannot be read."""
    try:
        if is_of_serial_arm(path):
            return Headline(f"{read_serial_arm(path).cross_validation.mean_mm:.3f} mm left")
        if is_of_resolution(path):
            return Headline(_of_tests(read_resolution(path).tests))
        u_mdeg = largest_map_u_mdeg(read_result(path))
        return None if u_mdeg is None else Headline(f"maps U ≤ {EXPANDED * u_mdeg:.1f} mdeg (k = 2)")
    except UsageError:
        return None


def _of_tests(tests: Sequence[AnyTest]) -> str:
    """Return the smallest and the largest least step, of lengths or of angles, whichever were tested first."""
    stated = [(test.lis.value, test.unit) for test in tests if test.lis is not None]
    if not stated:
        return counted(len(tests), "test")
    unit = stated[0][1]
    values = [value for value, of in stated if of == unit]
    ends = dict.fromkeys(with_unit(value, unit) for value in (min(values), max(values)))
    return f"steps {' … '.join(ends)}"


def headline_of_written(written: Written) -> Headline | None:
    """Return what stands for a file that a command has written; None where nothing does."""
    if written.command == "validate" and written.results and written.runs:
        return _of_validation(written.results[0], written.runs[0])
    if written.command == "compensate":
        return _of_commands(written.file)
    return None


def _of_validation(result: Path, run: Path) -> Headline:
    """Return what a result leaves on a run; it holds unless the validation speaks against the result."""
    try:
        worth = worth_of_validation(result, RunReader(run, Accept.UNCHECKED))
    except _UNUSABLE as error:
        return Headline(f"cannot be judged: {error}", holds=False)
    return Headline(worth.short or worth.figure, worth.sign in _HOLDS)


def _of_commands(file: Path) -> Headline | None:
    try:
        lines = lines_of(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    rows = sum(not is_comment(line) for line in lines) - 1
    return Headline(counted(rows, "command")) if rows > 0 else None


HEADLINES: Final = Headlines(headline_of_run, headline_of_result, headline_of_written)
