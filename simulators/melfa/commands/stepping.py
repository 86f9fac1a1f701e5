"""STEP and breakpoints (sheet, section 1.9), with or without the `=` that only formats of the sheet show.

What follows the words of breakpoints is that of a public client; see `catseye.simulators.melfa.breakpoints`.
"""

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.breakpoints import Breakpoint
from catseye.simulators.melfa.commands.command import Command, say, whole
from catseye.simulators.melfa.controller import Controller

_LAST_LINE = 32_767
_CONTINUOUS, _BACK, _END = "R", "B", "S"


def _step(controller: Controller, arguments: str) -> str:
    letter = arguments.removeprefix("=").upper()
    if letter == _CONTINUOUS:
        controller.task.step(single=False)
    elif letter == _BACK:
        controller.task.step_back()
    elif letter == _END:
        # Only what STEP has started.
        if controller.task.stepping:
            controller.stop()
    elif letter and letter in controller.choices.step_letters and len(letter) == 1:
        controller.task.step(single=True)
    else:
        raise Refusal(alarms.ILLEGAL_COMMAND)
    return ""


def _set(controller: Controller, arguments: str) -> str:
    name, line, kind = [*arguments.removeprefix("=").split(";"), "", ""][:3]
    program = controller.memory.find(name)
    number = whole(line, 1, _LAST_LINE)
    if number not in program.lines:
        raise Refusal(alarms.OUT_OF_RANGE)
    once = bool(whole(kind or "0", 0, 1))
    controller.task.breakpoints.put(Breakpoint(controller.memory.key(name), number, once))
    return ""


def _clear(controller: Controller, arguments: str) -> str:
    name, _, line = arguments.removeprefix("=").partition(";")
    controller.memory.find(name)
    controller.task.breakpoints.clear(controller.memory.key(name), whole(line or "0", 0, _LAST_LINE))
    return ""


def _list(controller: Controller, arguments: str) -> str:
    del arguments
    if not controller.choices.lists_breakpoints:
        raise Refusal(alarms.ILLEGAL_COMMAND)
    entries = [f"{one.program};{one.line};{int(one.once)}" for one in controller.task.breakpoints]
    listed = "\v".join(entries)
    return f"{listed};{len(entries)};0" if entries else ""


COMMANDS = {
    "STEP": Command(say(_step), arguments=True, right=True),
    "BRKPTSET": Command(say(_set), arguments=True),
    "BRKPTCLR": Command(say(_clear), arguments=True),
    "BRKPTGET": Command(say(_list), arguments=True, alone=True),
}
