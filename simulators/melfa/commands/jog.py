"""JOG (sheet, section 1.9): `JOG<mode>;00;<minus axes>;<plus axes>;<inching>`, hexadecimal.

Axes are bits, J1 or X the lowest. Axes that this arm does not have are left out; those of space are in
`catseye.simulators.melfa.jog_ways`.
"""

import re

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.commands.command import Command, say, unknown
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.jog_ways import SpaceAxes
from catseye.simulators.melfa.jogging import JointWay, SpaceWay, Way

_ARGUMENTS = re.compile(r"([0-9A-F]{2});00;([0-9A-F]{2});([0-9A-F]{2});(0[0-2])", re.IGNORECASE)
_JOINT_MODE = 0
_JOINTS, _AXES = 4, 6
_HIGH, _LOW = "01", "02"


def _jog(controller: Controller, arguments: str) -> str:
    found = _ARGUMENTS.fullmatch(arguments)
    if found is None:
        raise Refusal(alarms.ILLEGAL_COMMAND)
    mode, minus, plus = (int(found[n], 16) for n in (1, 2, 3))
    if minus & plus:
        raise Refusal(alarms.OUT_OF_RANGE)
    if controller.task.running:
        raise Refusal(alarms.WHILE_RUNNING)
    way = _way(mode, minus, plus)
    steps = {_HIGH: controller.choices.inch_high, _LOW: controller.choices.inch_low}
    if found[4] in steps:
        controller.jog.inch(way, steps[found[4]])
    else:
        controller.jog.go(way)
    return ""


def _way(mode: int, minus: int, plus: int) -> Way | None:
    """Return what is to move, None when nothing of this arm is."""
    directions = tuple((plus >> n & 1) - (minus >> n & 1) for n in range(_AXES))
    if mode == _JOINT_MODE:
        joints = directions[:_JOINTS]
        return JointWay(joints) if any(joints) else None
    try:
        axes = SpaceAxes(mode)
    except ValueError:
        raise Refusal(alarms.OUT_OF_RANGE) from None
    own = tuple(way if place in axes.places else 0 for place, way in enumerate(directions))
    return SpaceWay(axes, own) if any(own) else None


COMMANDS = {
    "JOG": Command(say(_jog), arguments=True, right=True),
    # Seen on the wire and undocumented.
    "JOGST": Command(unknown, arguments=True),
}
