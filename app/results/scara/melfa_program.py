"""A compensated path as a program in MELFA-BASIC: joint targets with their take-ups, at a capped speed.

Joint targets leave the controller's own kinematics, with its nominal links, out of it.
"""

import math
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass

from catseye.app.errors import UsageError
from catseye.app.results.scara.compensated_path import Origin
from catseye.app.results.scara.compensation import CompensatedPath, stop_poses
from catseye.drivers.roles.pose import Pose
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
    "Joint constants hold J1, J2 and J4 in deg and J3 in mm; {tool}. Three decimals are "
    "written, the arm's step of 1 mdeg: check whether your controller and your tool keep the third one.",
    "Before a reversal a joint overshoots and comes back (take-up): leave these lines in.",
)


@dataclass(frozen=True)
class MelfaSettings:
    """What the program takes from the cell file and the command line.

    Attributes:
        j3_mm: J3, where the path does not say its height.
        j4_deg: J4, where the path does not say its orientation.
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
    lines = [*_head(path, origin), f"Ovrd {settings.override_percent:g}", "Cnt 0"]
    poses = stop_poses(path, settings.j3_mm, settings.j4_deg)
    for number, (stop, pose) in enumerate(zip(path.stops, poses, strict=True)):
        lines += _stop(path, number, stop, pose, settings)
    lines.append("End")
    if len(lines) > _LAST_LINE:
        raise UsageError(
            f"the program would have {len(lines)} lines and may have {_LAST_LINE}: split the path into several files"
        )
    return "".join(f"{number} {line}\r\n" for number, line in enumerate(lines, 1))


def _head(path: CompensatedPath, origin: Origin) -> Iterator[str]:
    varying = [name for name, values in (("J3", path.j3_mm), ("J4", path.j4_deg)) if values is not None]
    fixed = [name for name in ("J3", "J4") if name not in varying]
    kept = {"J3": "J3 keeps the height of the path (z_mm)", "J4": "J4 keeps the tool's orientation (c_deg)"}
    tool = ", ".join([*(kept[name] for name in varying), *_same(fixed)])
    for text in (*(warning.replace("{tool}", tool) for warning in _WARNINGS), *origin.sentences()):
        # A controller shows its own set of characters.
        plain = text.encode("ascii", "replace").decode("ascii")
        yield from (f"' {line}" for line in textwrap.wrap(plain, _COMMENT_WIDTH))


def _same(fixed: list[str]) -> list[str]:
    if not fixed:
        return []
    return [f"{' and '.join(fixed)} {'is' if len(fixed) == 1 else 'are'} the same in every one"]


def _stop(
    path: CompensatedPath, number: int, stop: Waypoint, pose: Pose, settings: MelfaSettings
) -> Iterator[str]:
    if stop.command is None:
        following = path.stops[number + 1].command
        assert following is not None  # noqa: S101  # a take-up is always followed by the position that it is for
        yield f"' take-up before row {following.index + 1}"
    else:
        yield f"' {_place(path, stop.command)}"
    yield f"JC=({','.join(f'{value:.3f}' for value in pose)})"
    yield "Mov JC"
    if stop.command is not None:
        yield f"Dly {max(settings.settle_time_s, _SHORTEST_DELAY_S):.2f}"


def _place(path: CompensatedPath, command: Command) -> str:
    x_mm, y_mm = path.path.command_mm[command.index]
    sides = f"J1 from {_SIDES[command.direction1]}, J2 from {_SIDES[command.direction2]}"
    line, tool = _line(path, command.index), _tool(path, command.index)
    return f"{line}row {command.index + 1}: x {x_mm:.3f}, y {y_mm:.3f} mm, {sides}{tool}"


def _line(path: CompensatedPath, row: int) -> str:
    return "" if path.path.numbers is None else f"line {path.path.numbers[row]}, "


def _tool(path: CompensatedPath, row: int) -> str:
    """Return orientation and speed; a joint move does not know the speed along the path."""
    tool = path.path.tool
    texts = [] if tool.c_deg is None else [f"c {tool.c_deg[row]:.3f} deg"]
    if tool.speed_mm_s is not None and math.isfinite(tool.speed_mm_s[row]):
        texts.append(f"{tool.speed_mm_s[row]:g} mm/s asked for")
    return "".join(f", {text}" for text in texts)
