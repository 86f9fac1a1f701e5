"""What is said of a calibrated arm on measurements that it has not seen: figures by target, histograms, lengths."""

from dataclasses import replace
from typing import Final

import numpy as np

from catseye.app.results.figures import Figure
from catseye.app.results.model import Block, Cell, Column, Origin, Report, Table, section
from catseye.app.results.numbers import COUNT, fixed
from catseye.app.results.residual_sign import measured_minus_predicted
from catseye.app.results.serial_arm.figures import histograms, length_errors
from catseye.app.results.serial_arm.validation import ArmValidation

_MM = fixed(3)
_SIGNED = fixed(3, signed=True)
_SHOWN_BY: Final = ("table-validation", "table-by-target", "figure-validation-errors")


def arm_validation_report(found: ArmValidation, name: str, origin: Origin) -> Report:
    """Return the report of a validation.

    Args:
        name: of the measurements.
        origin: of measurements and result.
    """
    said = [replace(one, see=_SHOWN_BY) for one in found.statements()]
    blocks: list[Block] = [*said, _table(found), _by_target(found)]
    return Report(
        f"Validation with {name}",
        origin,
        (
            section("validation", "Validation", blocks, brief=True),
            section("figures", "Errors", _figures(found)),
        ),
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
        "By target, measured minus predicted length"
        if found.of_distances
        else "By target, lengths of the errors"
    )
    names = np.array(found.targets)
    first = (Column("target", "target"), Column("state", "state"), Column("n", "rows", "", COUNT))
    rows: list[tuple[Cell, ...]] = [
        (
            target,
            state,
            int(np.sum(names == target)),
            _mean(found, figures),
            figures["std_mm"],
            figures["max_mm"],
        )
        for target, state, figures in found.by_target()
    ]
    return Table("by-target", caption, _columns(first, signed=found.of_distances), tuple(rows))


def _mean(found: ArmValidation, figures: dict[str, float]) -> float:
    """Return the mean error of a target; sizes of errors in space have no sign."""
    return measured_minus_predicted(figures["mean_mm"]) if found.of_distances else figures["mean_mm"]


def _figures(found: ArmValidation) -> list[Figure]:
    sizes = [(state, errors.error_mm) for state, errors in found.states]
    figures = [histograms("validation-errors", "Errors on poses that were not used", sizes)]
    if found.of_distances:
        left = [(state, measured_minus_predicted(errors.signed_mm)) for state, errors in found.states]
        figures.append(length_errors(left, found.targets))
    return figures
