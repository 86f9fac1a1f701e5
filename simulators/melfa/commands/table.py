"""All commands, joined; which one a request means, and its execution.

Of the sheet, these are not modelled and answered with 6010: LINESRD, LS, ESEARCH, FINIT, THM and servo resets,
RAREAD, SLOTSET, RSTPWR, RPWRCHK, maintenance forecasts, brakes, origin setting, ERRORRD, HC framing, and what is seen
but undocumented (PRTVER, CHGPRT, SNREAD, PARCRC, JOGST, FQUIT, MESTRD02).
"""

import re

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import Run
from catseye.simulators.melfa.commands import (
    connection,
    editing,
    errors,
    files,
    jog,
    monitor,
    parameters,
    positions,
    running,
    signals,
    state,
    stepping,
    variables,
)
from catseye.simulators.melfa.commands.command import Client, Command
from catseye.simulators.melfa.controller import Controller

COMMANDS: dict[str, Command] = {
    **connection.COMMANDS,
    **running.COMMANDS,
    **stepping.COMMANDS,
    **state.COMMANDS,
    **positions.COMMANDS,
    **signals.COMMANDS,
    **errors.COMMANDS,
    **variables.COMMANDS,
    **editing.COMMANDS,
    **files.COMMANDS,
    **parameters.COMMANDS,
    **monitor.COMMANDS,
    **jog.COMMANDS,
}

_LONGEST_WORD = max(len(word) for word in COMMANDS)
_PREFIX = re.compile(r"(?:([0-9]*);(-?[0-9]*);)?(.*)", re.DOTALL)
_KEEPS_SEPARATORS = frozenset({"EMDAT"})


def carry_out(controller: Controller, client: Client, request: str) -> str | Run:
    """Carry out a request.

    Args:
        request: `[robot];[slot];COMMAND…`, without terminator.

    Raises:
        Refusal: the request is rejected.
    """
    word, arguments = split(request)
    command = COMMANDS[word]
    if command.right and client not in controller.right_holders:
        raise Refusal(alarms.NO_OPERATION_RIGHT)
    return command.handler(controller, client, arguments)


def split(request: str) -> tuple[str, str]:
    """Return the command word (the longest that fits) and its arguments; VT separates like a semicolon.

    Raises:
        Refusal: robot, slot or word do not exist.
    """
    found = _PREFIX.fullmatch(request)
    robot, slot, body = found.groups() if found else (None, None, request)
    if robot and int(robot[:4]) > 3:
        raise Refusal(alarms.BAD_ROBOT)
    if slot and slot != "-" and not -1 <= int(slot[:4]) <= 33:
        raise Refusal(alarms.SLOT_NOT_SELECTABLE)
    for length in range(min(len(body), _LONGEST_WORD), 0, -1):
        command = COMMANDS.get(body[:length])
        if command is not None and (command.arguments or length == len(body)):
            word, arguments = body[:length], body[length:]
            return word, arguments if word in _KEEPS_SEPARATORS else arguments.replace("\v", ";")
    raise Refusal(alarms.ILLEGAL_COMMAND)


def is_complete(request: str) -> bool:
    """Return True when a request may be all that its client has to say."""
    try:
        word, arguments = split(request)
    except Refusal:
        return False
    return bool(arguments) or not COMMANDS[word].arguments or COMMANDS[word].alone


def cannot_go_on(request: str) -> bool:
    """Return True when a request is complete as it stands: nothing could be added to its word."""
    try:
        word, arguments = split(request)
    except Refusal:
        return False
    longer = (other for other in COMMANDS if other != word and other.startswith(word))
    return not arguments and not COMMANDS[word].arguments and not any(longer)
