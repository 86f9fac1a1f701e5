"""Tables of the resolution paper from one's own tests: actuation, methods, least steps, reversal errors."""

from collections.abc import Sequence

from catseye.app.results.model import Cell, Column, Table
from catseye.app.results.numbers import COUNT, EXPANDED, NOTHING, decimals_for, duration_text, fixed, number
from catseye.app.results.resolution.naming import (
    POSITION,
    STEP,
    direction_sign,
    joints_of,
    least_step_text,
    named_positions,
    shipped_mark,
    with_unit,
)
from catseye.app.results.resolution.result import Actuation, AnyTest

_FACTOR = fixed(2)


def actuation_table(actuation: Sequence[Actuation]) -> Table | None:
    """Return what drives the joints and the least step that their encoders allow (Tables 1 and 4 of the paper)."""
    if not actuation:
        return None
    columns = (
        Column("joint", "joint"),
        Column("gear_ratio", "reduction ratio", format=_FACTOR),
        Column("encoder_bits", "encoder, one turn", "bit", COUNT),
        Column("ideal_lis_udeg", "ideal least step", "10⁻⁶ °", fixed(1)),
    )
    rows = tuple((one.joint, one.gear_ratio, one.encoder_bits, 1e6 * one.ideal_lis_deg) for one in actuation)
    return Table("actuation", "Reduction, encoder and ideal least increment step", columns, rows)


def method_table(tests: Sequence[AnyTest]) -> Table | None:
    """Return what both tests of the least step took and gave (Table 3 of the paper); None without one of each."""
    decaying = [test for test in tests if test.test == "decaying"]
    iso = [test for test in tests if test.test == "iso"]
    if not decaying or not iso:
        return None
    columns = (
        Column("criterion", "criterion"),
        Column("iso", "ISO 230"),
        Column("decaying", "decaying steps"),
    )
    rows: tuple[tuple[Cell, ...], ...] = (
        ("step sizes a test", *(_mean_count(members) for members in (iso, decaying))),
        ("duration of a test", *(_mean_duration(members) for members in (iso, decaying))),
        (
            "evaluation",
            "each step shows, by an objective criterion",
            "moving mean of step errors against a threshold",
        ),
        ("lost motion at reversals", "part of the result", "kept out; measured by the backlash test"),
        ("output", "least step", "least step with a 95 % interval, step errors"),
    )
    return Table("methods", "Tests of the least increment step", columns, rows)


def _mean_count(tests: Sequence[AnyTest]) -> str:
    counts = [len({round(abs(move.command), 12) for move in test.moves}) for test in tests]
    return str(round(sum(counts) / len(counts)))


def _mean_duration(tests: Sequence[AnyTest]) -> str:
    known = [test.duration_s for test in tests if test.duration_s is not None]
    return duration_text(sum(known) / len(known)) if known else NOTHING


def least_step_table(tests: Sequence[AnyTest], actuation: Sequence[Actuation]) -> Table | None:
    """Return the least steps of each joint and position by both tests (Tables 2 and 4 of the paper)."""
    shown = [test for test in tests if test.test in {"decaying", "iso"}]
    if not shown:
        return None
    ideal = {one.joint: one.ideal_lis_deg for one in actuation}
    with_rule = any(test.by_rule is not None for test in shown)
    columns = (
        Column("joint", "joint"),
        Column("position", "position"),
        Column("ideal_deg", "ideal", "°", STEP),
        Column("iso", "ISO 230"),
        Column("positive", "decaying steps, +"),
        Column("negative", "decaying steps, −"),
        *((Column("by_rule", "rule on the series, +, −"),) if with_rule else ()),
    )
    rows = [
        (
            joint,
            name,
            ideal.get(joint),
            *_least_steps([test for test in shown if test.joint == joint], position),
            *((_by_rule([test for test in shown if test.joint == joint], position),) if with_rule else ()),
        )
        for joint in joints_of(shown)
        for name, position in named_positions(shown, joint)
    ]
    return Table("least-steps", "Least increment step with its 95 % interval", columns, tuple(rows))


def _least_steps(tests: Sequence[AnyTest], position: float | None) -> tuple[Cell, Cell, Cell]:
    here = [test for test in tests if test.position == position]
    decaying = [test for test in here if test.test == "decaying"]
    return (
        _joined([test for test in here if test.test == "iso"]),
        _joined([test for test in decaying if test.direction == 1]),
        _joined([test for test in decaying if test.direction == -1]),
    )


def _by_rule(tests: Sequence[AnyTest], position: float | None) -> str:
    """Return the least steps by the rule on one series, forwards and backwards."""
    here = [test for test in tests if test.position == position]
    return ", ".join(
        "; ".join(
            with_unit(test.by_rule, test.unit) for test in here if test.by_rule and test.direction == way
        )
        or NOTHING
        for way in (1, -1)
    )


def _joined(tests: Sequence[AnyTest]) -> str | None:
    return "; ".join(least_step_text(test) for test in tests) or None


def reversal_table(tests: Sequence[AnyTest]) -> Table | None:
    """Return the reversal error of each joint by position, and whether it is play (Table 5 of the paper)."""
    shown = [test for test in tests if test.reversal is not None]
    if not shown:
        return None
    columns = (
        Column("joint", "joint"),
        Column("position", "position"),
        Column("reversal", "reversal error"),
        Column("u_expanded", "U (k=2)"),
        Column("valid", "torque changes its sign"),
        Column("torque", "torque forwards, backwards", "N m"),
    )
    rows = tuple(_reversal_row(test) for test in shown)
    return Table(
        "reversal", "Reversal error, lost motion positive (the negative of ISO 230-2's)", columns, rows
    )


def _reversal_row(test: AnyTest) -> tuple[Cell, ...]:
    found, torque = test.reversal, test.torque
    position = f"{with_unit(test.position, test.unit, POSITION)}{shipped_mark([test])}"
    if found is None:
        return (test.joint, position, None, None, None, None)
    decimals = STEP if found.u is None else fixed(decimals_for([found.u]))
    unknown = "no torque recorded" if test.torque is None else "torque by another clock"
    valid = {True: "yes: valid", False: "no: not valid", None: f"{unknown}: not valid"}[found.valid]
    measured = (
        None
        if torque is None
        else ", ".join(number(one, fixed(1)) for one in (torque.forward_nm, torque.backward_nm))
    )
    return (
        test.joint,
        position,
        with_unit(found.value, test.unit, decimals),
        with_unit(None if found.u is None else EXPANDED * found.u, test.unit, decimals),
        valid,
        measured,
    )


def cartesian_table(tests: Sequence[AnyTest]) -> Table | None:
    """Return measured least steps of Cartesian directions, a column a pose (Table 6 of the paper)."""
    shown = [test for test in tests if test.test == "cartesian"]
    if not shown:
        return None
    poses = list(dict.fromkeys(test.pose for test in shown))
    columns = (
        Column("direction", "direction"),
        *(Column(f"pose{place}", pose or "measured") for place, pose in enumerate(poses, 1)),
    )
    directions = list(dict.fromkeys((test.joint, test.direction) for test in shown))
    rows = tuple(
        (
            f"{direction_sign(direction)}{joint}",
            *(
                _joined(
                    [
                        test
                        for test in shown
                        if (test.joint, test.direction, test.pose) == (joint, direction, pose)
                    ]
                )
                for pose in poses
            ),
        )
        for joint, direction in directions
    )
    return Table("cartesian", "Least increment step of the tool with its 95 % interval", columns, rows)
