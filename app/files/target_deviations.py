"""Files of target deviations, `.rtl` (linear) and `.rta` (angular): what a laser calibration saw at its targets.

They hold no times, so they are no recordings. The layout is read off programs of third parties (the project's sheet
of interferometers, section 7): sections end with `::`, targets stand five to a line, deviations one to a line as run,
target, deviation, counted from 1. Deviations of `.rtl` are in µm; those of `.rta` have no unit that is certain.
"""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.csv_lines import named_faults
from catseye.calibration.core.types import Floats
from catseye.drivers.roles.text_table import plain_digits
from catseye.drivers.roles.user_file import read_regular

_COUNT: Final = re.compile(r"\s*(Target|Run)-count\s*:\s*(\d{1,9})\s*", re.IGNORECASE)
_AGAIN: Final = "export the file again"


@dataclass(frozen=True)
class TargetDeviations:
    """Deviations at targets.

    Attributes:
        target: mm of `.rtl`, deg of `.rta`, shape (targets,).
        deviation: as in the file, shape (runs, targets); odd runs go forwards, even ones backwards.
    """

    target: Floats
    deviation: Floats

    @property
    def forward(self) -> Floats:
        """Deviations of the runs forwards, shape (forward runs, targets)."""
        return self.deviation[0::2]

    @property
    def backward(self) -> Floats:
        """Deviations of the runs backwards, shape (backward runs, targets); empty of a test in one direction."""
        return self.deviation[1::2]


def read_target_deviations(path: Path) -> TargetDeviations:
    """Read a file of target deviations.

    Raises:
        UsageError: counts do not agree with what stands in the file, or a line is damaged; names the line.
    """
    lines = _lines(path)
    counts = {
        found[1].lower(): int(found[2]) for line in lines if (found := _COUNT.fullmatch(line)) is not None
    }
    targets, runs = counts.get("target"), counts.get("run")
    if not targets or not runs:
        raise UsageError(
            f"{path}: states no Target-count or no Run-count: this is not a .rtl or .rta file; {_AGAIN}"
        )
    if targets > len(lines) or runs * targets > len(lines):
        raise UsageError(
            f"{path}: states {runs} runs of {targets} targets, which is more than the file has lines: it is cut off, "
            f"or the counts are wrong; {_AGAIN}"
        )
    return TargetDeviations(
        np.array(_targets(path, lines, targets)), np.array(_deviations(path, lines, runs, targets))
    )


def _targets(path: Path, lines: list[str], count: int) -> list[float]:
    start = _after(path, lines, "targets")
    found: list[float] = []
    for number, line in enumerate(lines[start:], start + 1):
        if len(found) >= count:
            break
        values = _numbers(line)
        if values is None:
            raise UsageError(
                f"{path}:{number}: {line.strip()!r} holds no targets, but Target-count is {count}; {_AGAIN}"
            )
        found += values
    if len(found) != count:
        raise UsageError(
            f"{path}:{start}: {len(found)} targets stand below, but Target-count is {count}; {_AGAIN}"
        )
    return found


def _deviations(path: Path, lines: list[str], runs: int, targets: int) -> list[list[float]]:
    start = _after(path, lines, "run target data")
    rows = np.full((runs, targets), np.nan)
    for number, line in enumerate(lines[start : start + runs * targets], start + 1):
        values = _numbers(line)
        if values is None or not _is_deviation(values, runs, targets):
            raise UsageError(
                f"{path}:{number}: {line.strip()!r} is not a run (1…{runs}), target (1…{targets}) and deviation; "
                f"{_AGAIN}"
            )
        rows[int(values[0]) - 1, int(values[1]) - 1] = values[2]
    behind = start + runs * targets
    if behind < len(lines) and _numbers(lines[behind]):
        raise UsageError(
            f"{path}:{behind + 1}: numbers go on behind {runs} runs of {targets} targets, which Run-count and "
            f"Target-count announce: the counts are wrong; {_AGAIN}"
        )
    missing = np.argwhere(np.isnan(rows))
    if missing.size:
        run, target = missing[0] + 1
        raise UsageError(
            f"{path}: run {run} has no deviation at target {target}: the file is cut off; {_AGAIN}"
        )
    return [list(row) for row in rows]


def _is_deviation(values: list[float], runs: int, targets: int) -> bool:
    """Return whether the numbers of a line are run, target and deviation."""
    return len(values) == 3 and values[0] in range(1, runs + 1) and values[1] in range(1, targets + 1)


def _after(path: Path, lines: list[str], heading: str) -> int:
    """Return the place behind the line of a heading."""
    for place, line in enumerate(lines):
        if line.partition(":")[0].strip().lower() == heading:
            return place + 1
    raise UsageError(f"{path}: has no line {heading.capitalize()}: this is not a .rtl or .rta file; {_AGAIN}")


def _numbers(line: str) -> list[float] | None:
    """Return the numbers of a line; None when one of its words is none, or none that is finite."""
    try:
        values = [float(plain_digits(word).replace(",", ".")) for word in line.split()]
    except ValueError:
        return None
    return values if all(map(math.isfinite, values)) else None


def _lines(path: Path) -> list[str]:
    with named_faults(path):
        raw = read_regular(path)
    for encoding in ("utf-8-sig", "gbk"):
        try:
            return raw.decode(encoding).splitlines()
        except UnicodeDecodeError:
            continue
    return raw.decode("latin-1").splitlines()
