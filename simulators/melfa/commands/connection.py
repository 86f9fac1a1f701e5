"""Session: OPEN, CLOSE, operation right (sheet, sections 1.7 and 1.8)."""

from catseye.simulators.melfa.commands.command import Client, Command, nothing
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.programs import EXTENSION

_PATTERNS = {4: ("27", "0F"), 6: ("3F", "3F"), 8: ("FF", "FF")}


def _open(controller: Controller, client: Client, name: str) -> str:
    del client, name
    position, joint = _PATTERNS[controller.config.axis_pattern]
    fields = [
        position,
        joint,
        "7,0",
        "3,5,A,1E,32,46,64",
        EXTENSION,
        "PRM",
        "RH-3FRH5515-D",
        "CR800",
        "MELFA",
    ]
    fields += ["26-01-01", "Ver.A1", "ENG", "EMULATOR of catseye, not a product of the robot's maker"]
    return ";".join([*fields, "1", "1", "8", ""])


def _take_right(controller: Controller, client: Client, arguments: str) -> str:
    del arguments
    controller.take_right(client)
    return ""


def _give_right(controller: Controller, client: Client, arguments: str) -> str:
    del arguments
    controller.right_holders.discard(client)
    return ""


COMMANDS = {
    "OPEN=": Command(_open, arguments=True),
    "CLOSE": Command(_give_right),
    "CNTLON": Command(_take_right),
    "CNTLOFF": Command(_give_right),
    "KEYWD": Command(nothing, arguments=True, alone=True),
}
