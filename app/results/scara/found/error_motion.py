"""Radial error motion of J1 and J2, from a run that had an artefact on their axes read."""

from collections.abc import Sequence

import numpy as np

from catseye.app.results.figures import Axis, Figure, Level, Mark, Panel, Points, Role
from catseye.app.results.model import Block, Cell, Column, Section, Sign, Statement, Table, section
from catseye.app.results.numbers import EXPANDED, fixed
from catseye.app.store.reader import RunReader
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.standards.error_motion import (
    ErrorMotion,
    Gauging,
    RunOut,
    about_centre,
    error_motion,
)
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of, numbers_of, rows_of
from catseye.procedures.scara.radial.radial_error_motion import RESULT, RadialErrorMotion, RadialParams
from catseye.procedures.scara.radial.radial_plan import WHOLE_DEG
from catseye.procedures.scara.radial.reduction import run_out_of
from catseye.procedures.scara.records import RunOutReading

_UM = fixed(2)
_JOINT_COLUMNS = (
    Column("joint", "joint"),
    Column("from_deg", "from", "deg", fixed(0)),
    Column("to_deg", "to", "deg", fixed(0)),
    Column("rms_um", "rms", "µm", _UM),
    Column("expanded_um", "U of rms", "µm", _UM),
    Column("scatter_um", "scatter of a reading", "µm", _UM),
    Column("eccentricity_um", "eccentricity", "µm", fixed(1)),
    Column("form_um", "form of the artefact", "µm", _UM),
)
_VALUE_COLUMNS = (
    Column("joint", "joint"),
    Column("direction", "direction"),
    Column("total_um", "total", "µm", _UM),
    Column("average_um", "average", "µm", _UM),
    Column("asynchronous_um", "asynchronous", "µm", _UM),
    Column("reversal_um", "up less down, at most", "µm", _UM),
    Column("expanded_average_um", "U of average", "µm", _UM),
)
_RANGES = Statement(
    Sign.NEUTRAL,
    "A range grows with scatter: an average value is rather too large than too small, by no more than its U in 95 % "
    "of cases or more. The other values hold the scatter of the readings themselves and have no U.",
)
_SIDES = ((-1, Role.NEGATIVE, "downwards"), (1, Role.POSITIVE, "upwards"))
"""Approach, role and name, in the order of `ErrorMotion.motion_um`."""


def results_of(reader: RunReader) -> list[Row]:
    """Return what a run has found of each joint that it finished, as `motion_row` made it; none of another run."""
    if reader.meta.get("procedure") != RadialErrorMotion.name:
        return []
    found = (reader.result(f"{joint}/{RESULT}") for joint in _params_of(reader).joints)
    return [row for row in found if row is not None]


def _params_of(reader: RunReader) -> RadialParams:
    return RadialParams.model_validate(reader.meta["params"])


def error_motion_section(reader: RunReader) -> Section:
    """Return the error motion of each joint with its uncertainty; nothing of another run."""
    if reader.meta.get("procedure") != RadialErrorMotion.name:
        return section("error-motion", "Radial error motion", [])
    found = results_of(reader)
    blocks: list[Block | None] = []
    if found:
        blocks += [_verdict(found), *reservations(reader, found), _harmonic(_params_of(reader)), _RANGES]
        blocks += [_joints(found), _values(found)]
    if readings := reader.rows(RunOutReading.table):
        blocks.append(_figure(readings))
    return section("error-motion", "Radial error motion", blocks, brief=True)


def _verdict(found: Sequence[Row]) -> Statement:
    texts = [
        f"{row['joint']} {number_of(row, 'rms_um'):.2f} µm, U = {EXPANDED * number_of(row, 'u_rms_um'):.2f} µm"
        for row in found
    ]
    limits = [f"{row['joint']}, at most {limit_um(row):.2f} µm" for row in found if not is_resolved(row)]
    short = ", ".join(f"{row['joint']} {number_of(row, 'rms_um'):.1f} µm" for row in found)
    text = f"Radial error motion, rms along a direction (k = 2): {'; '.join(texts)}."
    if limits:
        text += f" Not resolved: {'; '.join(limits)} (rms + U)."
    return Statement(Sign.NEUTRAL, text, short, "; ".join(texts))


def is_resolved(row: Row) -> bool:
    """Return whether an error motion is larger than what is not known of it."""
    return number_of(row, "rms_um") > EXPANDED * number_of(row, "u_rms_um")


def limit_um(row: Row) -> float:
    """Return what an error motion is at most, resolved or not: rms + U."""
    return number_of(row, "rms_um") + EXPANDED * number_of(row, "u_rms_um")


def reservations(reader: RunReader, found: Sequence[Row]) -> list[Statement]:
    """Return why the values that a run has found may be too small or less certain than they say."""
    said = (*map(_arc, found), _not_stated(_params_of(reader)))
    return [each for each in said if each is not None]


def _arc(row: Row) -> Statement | None:
    arc_deg = number_of(row, "to_deg") - number_of(row, "from_deg")
    if arc_deg >= WHOLE_DEG:
        return None
    text = (
        f"{row['joint']} was measured over {arc_deg:g}° alone: the centre of a short arc takes a part of the error "
        "motion with it, so the values are lower limits."
    )
    return Statement(Sign.ATTENTION, text)


def _not_stated(params: RadialParams) -> Statement | None:
    missing = []
    if params.u_indicator_um is None:
        missing.append("the indicator's own error (u_indicator_um)")
    if params.form_um is None and not params.reversal:
        missing.append("the artefact's deviation from roundness (form_um, or reversal)")
    if not missing:
        return None
    text = (
        f"Not stated, so not in U: {' and '.join(missing)}. The rms holds it all; the degrees of freedom that go "
        "into the error budget are an upper limit."
    )
    return Statement(Sign.ATTENTION, text)


def _harmonic(params: RadialParams) -> Statement:
    if params.directions == "x":
        text = "Read in one direction: the first harmonic counts as eccentricity and is not in the values."
    else:
        text = (
            "The part of the first harmonic that turns with the joint counts as eccentricity and is not in the "
            "values: it lengthens the link, and the identified length holds it."
        )
    return Statement(Sign.NEUTRAL, text)


def _joints(found: Sequence[Row]) -> Table:
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (
            str(row["joint"]),
            *(number_of(row, key) for key in ("from_deg", "to_deg", "rms_um")),
            EXPANDED * number_of(row, "u_rms_um"),
            number_of(row, "scatter_um"),
            max(numbers_of(row, "eccentricity_um")),
            None if row["form_um"] is None else number_of(row, "form_um"),
        )
        for row in found
    )
    return Table(
        "error-motion", "Radial error motion about the least-squares centre (k = 2)", _JOINT_COLUMNS, rows
    )


def _values(found: Sequence[Row]) -> Table:
    keys = ("total_um", "average_um", "asynchronous_um", "reversal_um")
    rows: tuple[tuple[Cell, ...], ...] = tuple(
        (
            str(row["joint"]),
            str(each["direction"]),
            *(number_of(each, key) for key in keys),
            # Runs were made before it was found.
            None if row.get("expanded_average_um") is None else number_of(row, "expanded_average_um"),
        )
        for row in found
        for each in rows_of(row, "values")
    )
    return Table(
        "error-motion-values", "Radial error motion values (ISO 230-7; U: 95 % or more)", _VALUE_COLUMNS, rows
    )


def _figure(readings: Sequence[Row]) -> Figure:
    joints = list(dict.fromkeys(str(row["joint"]) for row in readings))
    rows = tuple(_panels(joint, [row for row in readings if row["joint"] == joint]) for joint in joints)
    caption = (
        "What the indicator reads about the least-squares centre, by the angle of the joint and the side from which "
        "it came. While a joint is being read, every reading; then the means over the cycles."
    )
    return Figure("error-motion", "Radial error motion", caption, rows, aspect=0.2 + 0.25 * len(rows))


def _panels(joint: str, readings: Sequence[Row]) -> tuple[Panel, ...]:
    """Return a panel for each direction."""
    run_out = run_out_of(readings)
    directions = dict.fromkeys(sorted(str(row["direction"]) for row in readings))
    try:
        curves = _means(error_motion(run_out, Gauging(0.0)))
    except InsufficientPointsError:
        curves = _so_far(run_out)
    return tuple(
        Panel(
            f"{joint}, {direction}",
            Axis(f"{joint} / °"),
            Axis("error motion / µm"),
            (Level(0.0, Role.AXIS), *curves[number]),
        )
        for number, direction in enumerate(directions)
    )


def _means(found: ErrorMotion) -> list[tuple[Mark, ...]]:
    """Return the means over the cycles in each direction."""
    angle_deg = np.rad2deg(found.angle_rad)
    return [
        tuple(
            Points(angle_deg, motion_um, role, label, joined=True)
            for motion_um, (_, role, label) in zip(along, _SIDES, strict=True)
        )
        for along in found.motion_um
    ]


def _so_far(run_out: RunOut) -> list[tuple[Mark, ...]]:
    """Return every reading in each direction, of a joint that has not been read to the end."""
    residual_um, _ = about_centre(run_out)
    motion_um = np.where(run_out.turned, -residual_um, residual_um)
    curves: list[tuple[Mark, ...]] = []
    for direction_rad in np.unique(run_out.direction_rad):
        here = run_out.direction_rad == direction_rad
        curves.append(
            tuple(
                Points(np.rad2deg(run_out.angle_rad[own]), motion_um[own], role, label)
                for approach, role, label in _SIDES
                if (own := here & (run_out.approach == approach)).any()
            )
        )
    return curves
