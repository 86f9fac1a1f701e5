"""What is said of a calibrated arm on measurements that it has not seen: figures by target, histograms, lengths."""

import numpy as np

from catseye.app.results.figures import Figure
from catseye.app.results.model import Block, Cell, Column, Origin, Report, Sign, Statement, Table, section
from catseye.app.results.numbers import COUNT, counted, fixed
from catseye.app.results.serial_arm.figures import histograms, length_errors
from catseye.app.results.serial_arm.validation import ArmValidation

_MM = fixed(3)
_SIGNED = fixed(3, signed=True)


def arm_validation_report(found: ArmValidation, name: str, origin: Origin) -> Report:
    """Return the report of a validation.

    Args:
        name: of the measurements.
        origin: of measurements and result.
    """
    blocks: list[Block] = [*_statements(found), _table(found), _by_target(found)]
    return Report(
        f"Validation with {name}",
        origin,
        (
            section("validation", "Validation", blocks, brief=True),
            section("figures", "Errors", _figures(found)),
        ),
    )


def _statements(found: ArmValidation) -> list[Statement]:
    after = found.calibrated.figures()
    what = "measured length" if found.of_distances else "measured target"
    said = [
        Statement(
            Sign.GOOD,
            f"{counted(len(found.targets), what)}: the calibrated arm misses them by {after['mean_mm']:.3f} mm on "
            f"the average, {after['max_mm']:.3f} mm at most.",
        ),
        _inside(found),
    ]
    if found.fitted:
        said.append(
            Statement(
                Sign.ATTENTION,
                f"Nobody said where {', '.join(found.fitted)} stands: each state of the arm has its own best place, "
                "which takes a part of the errors. State it by --anchors.",
            )
        )
    if found.dead_paths:
        said.append(
            Statement(
                Sign.ATTENTION,
                f"The result does not know the dead path of {', '.join(found.dead_paths)}: each state of the arm has "
                "its own best one, which takes the mean of its errors.",
            )
        )
    return said


def _inside(found: ArmValidation) -> Statement:
    if found.inside_95_percent is None:
        return Statement(
            Sign.NEUTRAL,
            "The table states no uncertainties, and the calibration had other rows: whether the errors are as large "
            "as they may be is not judged. State u_mm.",
        )
    rows = (
        "of the stated uncertainties"
        if found.assumed_u_mm is None
        else f"of predictions and rows. The table states no u_mm: its rows were taken to scatter as those of the "
        f"calibration, by {found.assumed_u_mm:.2g} mm"
    )
    return Statement(
        Sign.NEUTRAL if found.inside_95_percent >= 90.0 else Sign.ATTENTION,
        f"{found.inside_95_percent:.0f} % of the errors lie within the 95 % region {rows}.",
    )


def _columns(first: tuple[Column, ...], *, signed: bool) -> tuple[Column, ...]:
    return (
        *first,
        Column("mean_mm", "mean error", "mm", _SIGNED if signed else _MM),
        Column("std_mm", "standard deviation", "mm", _MM),
        Column("max_mm", "largest", "mm", _MM),
    )


def _table(found: ArmValidation) -> Table:
    caption = "Sizes of the errors on poses that the calibration has not seen"
    rows: list[tuple[Cell, ...]] = [(state, *errors.figures().values()) for state, errors in found.states]
    return Table("validation", caption, _columns((Column("state", "state"),), signed=False), tuple(rows))


def _by_target(found: ArmValidation) -> Table:
    caption = (
        "By target, predicted minus measured length"
        if found.of_distances
        else "By target, lengths of the errors"
    )
    names = np.array(found.targets)
    first = (Column("target", "target"), Column("state", "state"), Column("n", "rows", "", COUNT))
    rows: list[tuple[Cell, ...]] = [
        (target, state, int(np.sum(names == target)), *figures.values())
        for target, state, figures in found.by_target()
    ]
    return Table("by-target", caption, _columns(first, signed=found.of_distances), tuple(rows))


def _figures(found: ArmValidation) -> list[Figure]:
    sizes = [(state, errors.error_mm) for state, errors in found.states]
    figures = [histograms("validation-errors", "Errors on poses that were not used", sizes)]
    if found.of_distances:
        figures.append(
            length_errors([(state, errors.signed_mm) for state, errors in found.states], found.targets)
        )
    return figures
