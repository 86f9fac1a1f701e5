"""Positions (sheet, section 1.11).

No source gives the axis names of XPOS and RPOS: they are assumed to be X, Y, Z and the wrist's joints, and radius
R, angle T and Z in the place of X, Y and Z.
"""

import math
from collections.abc import Callable

from catseye.simulators.config import Joints
from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.commands.command import Command, say, show
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.values import flags_text, joint_pairs, position_pairs

_NO_FLAGS = "****,****"
Pairs = list[tuple[str, float]]


def _joints(controller: Controller, joints: Joints) -> tuple[Pairs, str]:
    return joint_pairs(joints, controller.config.axis_pattern), _NO_FLAGS


def _position(controller: Controller, joints: Joints) -> tuple[Pairs, str]:
    position = controller.position_of(joints)
    return position_pairs(position, controller.config.axis_pattern), flags_text(position)


def _three_axes(controller: Controller, joints: Joints) -> tuple[Pairs, str]:
    pairs, flags = _position(controller, joints)
    return pairs[:3] + joint_pairs(joints, controller.config.axis_pattern)[3:], flags


def _cylinder(controller: Controller, joints: Joints) -> tuple[Pairs, str]:
    pairs, flags = _position(controller, joints)
    x_mm, y_mm = pairs[0][1], pairs[1][1]
    angle_deg = math.degrees(math.atan2(y_mm, x_mm))
    return [("R", math.hypot(x_mm, y_mm)), ("T", angle_deg), *pairs[2:]], flags


def _read(controller: Controller, kind: str, which: str, joints: Joints) -> str:
    pairs, flags = _KINDS[kind](controller, joints)
    if which not in {"", "F"}:
        if which not in {str(n) for n in range(1, len(pairs) + 1)}:
            raise Refusal(alarms.ILLEGAL_COMMAND)
        pairs = [pairs[int(which) - 1]]
    values = "".join(f"{name};{value:.2f};" for name, value in pairs)
    speed = controller.tool_speed_mm_s()
    return f"{values};{flags};{controller.override_percent};{speed:.2f};00000000"


_KINDS: dict[str, Callable[[Controller, Joints], tuple[Pairs, str]]] = {
    "J": _joints,
    "P": _position,
    "X": _three_axes,
    "R": _cylinder,
}


def _present(kind: str) -> Command:
    return Command(say(lambda c, which: _read(c, kind, which, c.shown_joints)), arguments=True, alone=True)


def _complete(kind: str) -> Command:
    return Command(show(lambda c: _read(c, kind, "F", c.shown_joints)))


def _destination(kind: str) -> Command:
    return Command(show(lambda c: _read(c, kind, "F", c.arm.destination)))


COMMANDS = {
    **{f"{kind}POS": _present(kind) for kind in _KINDS},
    **{f"{kind}POSF": _complete(kind) for kind in _KINDS},
    "GJPOSF": _destination("J"),
    "GPPOSF": _destination("P"),
}
