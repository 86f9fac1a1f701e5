"""A compensated path as a program in MELFA-BASIC: joint targets with their take-ups, at a capped speed.

Joint targets leave the controller's own kinematics, with its nominal links, out of it.
"""

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass

from catseye.app.errors import UsageError
from catseye.app.results.scara.compensated_path import Origin
from catseye.app.results.scara.compensation import CompensatedPath
from catseye.procedures.scara.motion.approach import Command, Waypoint

_COMMENT_WIDTH = 100
"""Leaves room for line number and mark within the 127 characters of a line."""

_LAST_LINE = 32_767

_SHORTEST_DELAY_S = 0.05
"""Older controllers take no shorter one."""

_SIDES = {1: "below", -1: "above"}

_WARNINGS = (
    "THIS PROGRAM MOVES A REAL ARM. Check it in single step at low speed, a hand on the stop, before it runs by "
    "itself.",
    "Switch the servo on first, choose one cycle (no repeat), keep the reach of the arm free of people and things, "
    "the way to the first position too: it leads there from wherever the arm stands.",
    "Joint constants hold J1, J2 and J4 in deg and J3 in mm; J3 and J4 are the same in every one. Three decimals are "
    "written, the arm's step of 1 mdeg: look whether your controller and your tool keep the third one.",
    "Before a reversal a joint overshoots and comes back (take-up): leave these lines in.",
)


@dataclass(frozen=True)
class MelfaSettings:
    """What the program holds constant.

    Attributes:
        j3_mm: height.
        j4_deg: angle of J4.
        override_percent: cap of the speed.
        settle_time_s: standstill at each position.
    """

    j3_mm: float
    j4_deg: float
    override_percent: float
    settle_time_s: float


def melfa_program(path: CompensatedPath, origin: Origin, settings: MelfaSettings) -> str:
    """Return the program's text, lines numbered from 1.

    Raises:
        UsageError: it would have more lines than a program may have.
    """
    lines = [*_head(origin), f"Ovrd {settings.override_percent:g}", "Cnt 0"]
    for number, stop in enumerate(path.stops):
        lines += _stop(path, number, stop, settings)
    lines.append("End")
    if len(lines) > _LAST_LINE:
        raise UsageError(
            f"the program would have {len(lines)} lines and may have {_LAST_LINE}: split the path into several files"
        )
    return "".join(f"{number} {line}\r\n" for number, line in enumerate(lines, 1))


def _head(origin: Origin) -> Iterator[str]:
    for text in (*_WARNINGS, *origin.sentences()):
        # A controller shows its own set of characters.
        plain = text.encode("ascii", "replace").decode("ascii")
        yield from (f"' {line}" for line in textwrap.wrap(plain, _COMMENT_WIDTH))


def _stop(path: CompensatedPath, number: int, stop: Waypoint, settings: MelfaSettings) -> Iterator[str]:
    if stop.command is None:
        following = path.stops[number + 1].command
        assert following is not None  # noqa: S101  # a take-up is always followed by the position that it is for
        yield f"' take-up before row {following.index + 1}"
    else:
        yield f"' {_place(path, stop.command)}"
    joints = (stop.theta1_deg, stop.theta2_deg, settings.j3_mm, settings.j4_deg)
    yield f"JC=({','.join(f'{value:.3f}' for value in joints)})"
    yield "Mov JC"
    if stop.command is not None:
        yield f"Dly {max(settings.settle_time_s, _SHORTEST_DELAY_S):.2f}"


def _place(path: CompensatedPath, command: Command) -> str:
    x_mm, y_mm = path.path.command_mm[command.index]
    sides = f"J1 from {_SIDES[command.direction1]}, J2 from {_SIDES[command.direction2]}"
    return f"row {command.index + 1}: x {x_mm:.3f}, y {y_mm:.3f} mm, {sides}"
