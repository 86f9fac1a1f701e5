"""The figure that stands for a finished stage: what a run has found, or what a result is worth."""

from pathlib import Path

from catseye.app.errors import CatseyeError, UsageError
from catseye.app.results.found import found_sections
from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import EXPANDED, counted
from catseye.app.results.readiness.headline import Headline
from catseye.app.results.resolution.recorded_runs import holds_tests
from catseye.app.results.resolution.report_files import is_of_resolution
from catseye.app.results.resolution.result import read_resolution
from catseye.app.results.scara.result import read_result
from catseye.app.results.scara.values import largest_map_u_mdeg
from catseye.app.results.serial_arm.result import is_of_serial_arm, read_serial_arm
from catseye.app.store.reader import Accept, RunReader
from catseye.calibration.core.errors import CalibrationError


def headline_of_run(path: Path) -> Headline | None:
    """Return what a run has found; None of a run from which something is computed first."""
    try:
        reader = RunReader(path, Accept.UNCHECKED)
        # Evaluating recordings takes its time, and has a stage of its own.
        sections = [] if holds_tests(reader) else found_sections(reader)
    except (CatseyeError, CalibrationError, LookupError, TypeError, ValueError):
        # Another version may have stored it, or somebody has changed it: the run itself counts all the same.
        return None
    said = (block for one in sections for block in one.blocks if isinstance(block, Statement) and block.short)
    first = next(said, None)
    return None if first is None else Headline(first.short, first.sign in {Sign.GOOD, Sign.NEUTRAL})


def headline_of_result(path: Path) -> Headline | None:
    """Return what a result is worth; None of a file that cannot be read."""
    try:
        if is_of_serial_arm(path):
            return Headline(f"{read_serial_arm(path).cross_validation.mean_mm:.3f} mm left")
        if is_of_resolution(path):
            return Headline(counted(len(read_resolution(path).tests), "test"))
        u_mdeg = largest_map_u_mdeg(read_result(path))
        return None if u_mdeg is None else Headline(f"maps U ≤ {EXPANDED * u_mdeg:.1f} mdeg (k = 2)")
    except UsageError:
        return None
