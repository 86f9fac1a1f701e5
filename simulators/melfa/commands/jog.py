"""JOG (sheet, section 1.9): `JOG<mode>;00;<minus axes>;<plus axes>;<inching>`, hexadecimal.

Joint jog only: jogging along Cartesian axes needs straight motion, which the arm of this bench does not have; it
is refused with 3110. Axes beyond the fourth do not exist and are left out.
"""

import re

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.commands.command import Command, say
from catseye.simulators.melfa.controller import Controller

_ARGUMENTS = re.compile(r"([0-9A-F]{2});00;([0-9A-F]{2});([0-9A-F]{2});(0[0-2])", re.IGNORECASE)
_JOINT_MODE = 0
_HIGH, _LOW = "01", "02"


def _jog(controller: Controller, arguments: str) -> str:
    found = _ARGUMENTS.fullmatch(arguments)
    if found is None:
        raise Refusal(alarms.ILLEGAL_COMMAND)
    mode, minus, plus = (int(found[n], 16) for n in (1, 2, 3))
    if mode != _JOINT_MODE or minus & plus:
        raise Refusal(alarms.OUT_OF_RANGE)
    if controller.task.running:
        raise Refusal(alarms.WHILE_RUNNING)
    j1, j2, j3, j4 = ((plus >> n & 1) - (minus >> n & 1) for n in range(4))
    steps = {_HIGH: controller.choices.inch_high, _LOW: controller.choices.inch_low}
    if found[4] in steps:
        controller.jog.inch((j1, j2, j3, j4), steps[found[4]])
    else:
        controller.jog.go((j1, j2, j3, j4))
    return ""


COMMANDS = {"JOG": Command(say(_jog), arguments=True, right=True)}
