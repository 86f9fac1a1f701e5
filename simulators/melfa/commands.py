"""Commands of the R-protocol (sheet, sections 1.7 to 1.14): words, rights, and what each does."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from simulators.melfa import alarms, statements
from simulators.melfa.alarms import Refusal
from simulators.melfa.controller import Controller, Run
from simulators.melfa.values import flags_text, joint_pairs, number, position_pairs

_EPOCH = datetime(2026, 1, 1, tzinfo=UTC)
"""The controller's clock starts here at bench time 0, so that a transcript can be repeated."""

_PATTERNS = {4: ("27", "0F"), 6: ("3F", "3F"), 8: ("FF", "FF")}
_LEVEL_LETTERS = {alarms.HIGH: "H", alarms.LOW: "L", alarms.CAUTION: "C"}
_PREFIX = re.compile(r"(?:(\d*);(-?\d*);)?(.*)", re.DOTALL)


@dataclass
class Client:
    """What the controller knows about one connection.

    Attributes:
        operation_right: it may move the robot (CNTLON).
        log_place: where it stands in the error log.
    """

    operation_right: bool = False
    log_place: int = 0


Handler = Callable[[Controller, Client, str], str | Run]
"""Carries out a command with its arguments; returns the answer's text, or the motion to wait for."""


@dataclass(frozen=True)
class Command:
    """One command word.

    Attributes:
        handler: what it does.
        arguments: something may follow the word.
        right: it needs the operation right.
    """

    handler: Handler
    arguments: bool = False
    right: bool = False


def carry_out(controller: Controller, client: Client, request: str) -> str | Run:
    """Carry out a request.

    Args:
        controller: the controller.
        client: who asks.
        request: `[robot];[slot];COMMAND…`, without terminator.

    Raises:
        Refusal: the request is rejected.
    """
    word, arguments = split(request)
    command = COMMANDS[word]
    if command.right and not client.operation_right:
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
            return body[:length], body[length:].replace("\v", ";")
    raise Refusal(alarms.ILLEGAL_COMMAND)


def cannot_go_on(request: str) -> bool:
    """Return True when a request is complete as it stands: nothing could be added to its word."""
    try:
        word, arguments = split(request)
    except Refusal:
        return False
    longer = (other for other in COMMANDS if other != word and other.startswith(word))
    return not arguments and not COMMANDS[word].arguments and not any(longer)


def _open(controller: Controller, client: Client, name: str) -> str:
    del client, name
    position, joint = _PATTERNS[controller.config.axis_pattern]
    fields = [position, joint, "7,0", "3,5,A,1E,32,46,64", "MB6", "PRM", "RH-3FRH5515-D", "CR800", "MELFA"]
    fields += ["26-01-01", "Ver.A1", "ENG", "EMULATOR of catseye, not a product of the robot's maker"]
    return ";".join([*fields, "1", "1", "8", ""])


def _take_right(controller: Controller, client: Client, arguments: str) -> str:
    del controller, arguments
    client.operation_right = True
    return ""


def _give_right(controller: Controller, client: Client, arguments: str) -> str:
    del controller, arguments
    client.operation_right = False
    return ""


def _do(action: Callable[[Controller], None]) -> Handler:
    def handler(controller: Controller, client: Client, arguments: str) -> str:
        del client, arguments
        action(controller)
        return ""

    return handler


def _say(text: Callable[[Controller, str], str]) -> Handler:
    def handler(controller: Controller, client: Client, arguments: str) -> str:
        del client
        return text(controller, arguments)

    return handler


def _latch_stop(controller: Controller) -> None:
    controller.stop_latched = True
    controller.stop()


def _release_stop(controller: Controller) -> None:
    controller.stop_latched = False


def _set_override(controller: Controller, arguments: str) -> str:
    percent = _number(arguments)
    if not 1.0 <= percent <= 100.0:
        raise Refusal(alarms.OUT_OF_RANGE)
    controller.override_percent = percent
    return f"{percent:g}"


def _number(text: str) -> float:
    if not text.strip():
        raise Refusal(alarms.SYNTAX)
    return number(text)


def _run(controller: Controller, arguments: str) -> str:
    del controller
    # No program can be loaded: a named one does not exist, and none is selected.
    raise Refusal(alarms.NO_PROGRAM if arguments.strip() else alarms.NOTHING_SELECTED)


def _no_program(controller: Controller, arguments: str) -> str:
    del controller, arguments
    raise Refusal(alarms.NO_PROGRAM)


def _status_bits(controller: Controller, client: Client) -> str:
    run = 0x01 | 0x20 * controller.servo_on | 0x40 * controller.bench.moving | 0x80 * client.operation_right
    stop = 0x01 * controller.emergency_stop | 0x02 * controller.stopped | 0x10
    return f"{run:02X}{stop:02X}{controller.alarm}"


def _state(controller: Controller, client: Client, arguments: str) -> str:
    del arguments
    bits = _status_bits(controller, client)
    moving = int(controller.bench.moving)
    return f";0;{controller.override_percent:g};0;{bits};0;1;;;;;;;;;REP;START;1;{moving}"


def _short_state(controller: Controller, client: Client, arguments: str) -> str:
    del arguments
    return f"{_status_bits(controller, client)};0;{int(controller.bench.moving)}"


def _joints(controller: Controller, arguments: str) -> str:
    pairs = joint_pairs(controller.bench.joints, controller.config.axis_pattern)
    return _position_answer(controller, pairs, arguments, "****,****")


def _position(controller: Controller, arguments: str) -> str:
    position = controller.position()
    pairs = position_pairs(position, controller.config.axis_pattern)
    return _position_answer(controller, pairs, arguments, flags_text(position))


def _joint_destination(controller: Controller, arguments: str) -> str:
    pairs = joint_pairs(controller.bench.destination, controller.config.axis_pattern)
    return _position_answer(controller, pairs, arguments, "****,****")


def _position_destination(controller: Controller, arguments: str) -> str:
    position = controller.position_of(controller.bench.destination)
    pairs = position_pairs(position, controller.config.axis_pattern)
    return _position_answer(controller, pairs, arguments, flags_text(position))


def _position_answer(controller: Controller, pairs: list[tuple[str, float]], which: str, flags: str) -> str:
    if which not in {"", "F"}:
        if which not in {str(n) for n in range(1, len(pairs) + 1)}:
            raise Refusal(alarms.ILLEGAL_COMMAND)
        pairs = [pairs[int(which) - 1]]
    values = "".join(f"{name};{value:.2f};" for name, value in pairs)
    speed = controller.tool_speed_mm_s()
    return f"{values};{flags};{controller.override_percent:g};{speed:.2f};00000000"


def _execute(controller: Controller, arguments: str) -> str:
    statements.execute(controller, arguments)
    return ""


def _execute_and_wait(controller: Controller, client: Client, arguments: str) -> str | Run:
    del client
    return statements.execute(controller, arguments) or ""


def _error(controller: Controller, arguments: str) -> str:
    del arguments
    return f"{controller.alarm};{alarms.level(controller.alarm)}" if controller.alarm else ""


def _error_text(controller: Controller, arguments: str) -> str:
    del controller
    return alarms.text(int(_number(arguments)))


def _error_log(controller: Controller, client: Client, arguments: str) -> str:
    last = len(controller.log) - 1
    places = {"TOP": last, "END": 0, "+1": client.log_place + 1, "-1": client.log_place - 1}
    if arguments not in places:
        raise Refusal(alarms.ILLEGAL_COMMAND)
    place = places[arguments]
    if not 0 <= place <= last:
        return ""
    client.log_place = place
    line = controller.log[place]
    when = _EPOCH + timedelta(seconds=line.time_s)
    level = _LEVEL_LETTERS[alarms.level(line.number)]
    text = alarms.text(line.number)
    return f"{when:%y-%m-%d;%H:%M:%S};{line.number};{text};{level};;0;{line.number:04d}00000"


def _stop_sources(controller: Controller, arguments: str) -> str:
    del arguments
    return f"{2 * controller.stop_latched:X};{int(controller.emergency_stop):X}"


def _parameter(controller: Controller, arguments: str) -> str:
    limits = [bound for axis in controller.config.limits for bound in axis]
    rest = controller.config.start_joints
    known: dict[str, list[float]] = {
        "MEJAR": limits + [0.0] * 8,
        "JSAFE": [*rest, 0.0, 0.0, 0.0, 0.0],
        "MEXTL": [0.0] * 6,
    }
    if arguments == "RLNG":
        return "RLNG;1;1"
    if arguments not in known:
        raise Refusal(alarms.OUT_OF_RANGE)
    values = known[arguments]
    return f"{arguments};{', '.join(f'{value:.2f}' for value in values)};{len(values)}"


def _read_variable(controller: Controller, arguments: str) -> str:
    name = arguments.strip().upper()
    return f"{name}={statements.value_text(statements.read(controller, name))}"


def _write_variable(controller: Controller, arguments: str) -> str:
    name, separator, value = arguments.partition("=")
    if not separator:
        raise Refusal(alarms.SYNTAX)
    statements.assign(controller, name.strip().upper(), value.strip().upper())
    return ""


def _write_running(controller: Controller, arguments: str) -> str:
    return _write_variable(controller, arguments.partition(";")[2])


def _time(controller: Controller, arguments: str) -> str:
    del arguments
    return f"{_EPOCH + timedelta(seconds=controller.bench.time_s):%y-%m-%d%H:%M:%S}"


def _input(controller: Controller, arguments: str) -> str:
    del controller
    _signal(arguments)
    return "0000"


def _output(controller: Controller, arguments: str) -> str:
    return f"{controller.outputs.get(_signal(arguments), 0):04X}"


def _set_output(controller: Controller, arguments: str) -> str:
    signal, _, bits = arguments.partition(";")
    if re.fullmatch(r"[0-9A-Fa-f]{1,4}", bits) is None:
        raise Refusal(alarms.SYNTAX)
    controller.outputs[_signal(signal)] = int(bits, 16)
    return ""


def _signal(text: str) -> int:
    if re.fullmatch(r"\d{1,5}", text) is None or int(text) > 255:
        raise Refusal(6600)
    return int(text)


def _hand(controller: Controller, arguments: str) -> str:
    del controller
    if re.fullmatch(r"[1-8]", arguments) is None:
        raise Refusal(alarms.OUT_OF_RANGE)
    return ""


_nothing = _do(lambda _controller: None)

COMMANDS: dict[str, Command] = {
    "OPEN=": Command(_open, arguments=True),
    "CLOSE": Command(_give_right),
    "CNTLON": Command(_take_right),
    "CNTLOFF": Command(_give_right),
    "SRVON": Command(_do(Controller.switch_servo_on), right=True),
    "SRVOFF": Command(_do(Controller.switch_servo_off), right=True),
    "OVRD": Command(_say(lambda c, _a: f"{c.override_percent:g}")),
    "OVRD=": Command(_say(_set_override), arguments=True, right=True),
    "RUN": Command(_say(_run), arguments=True, right=True),
    "PRGLOAD=": Command(_say(_no_program), arguments=True, right=True),
    "STOP": Command(_do(Controller.stop)),
    "STOPON": Command(_do(_latch_stop)),
    "STOPOFF": Command(_do(_release_stop)),
    # Cycle stop ends a program after its cycle; a motion of direct execution goes on.
    "CSTOP": Command(_nothing),
    "RSTALRM": Command(_do(Controller.reset_alarm)),
    "SLOTINIT": Command(_nothing),
    "RSTPRG": Command(_nothing),
    "STATE": Command(_state),
    "DSTATE": Command(_short_state),
    "JPOS": Command(_say(_joints), arguments=True),
    "JPOSF": Command(_say(_joints)),
    "PPOS": Command(_say(_position), arguments=True),
    "PPOSF": Command(_say(_position)),
    "GJPOSF": Command(_say(_joint_destination)),
    "GPPOSF": Command(_say(_position_destination)),
    "EXEC": Command(_say(_execute), arguments=True, right=True),
    "EXEC2=": Command(_execute_and_wait, arguments=True, right=True),
    "ERROR": Command(_say(_error)),
    "ERRORMES": Command(_say(_error_text), arguments=True),
    "ERRORLOG": Command(_error_log, arguments=True),
    "STPSIG": Command(_say(_stop_sources)),
    "PNR": Command(_say(_parameter), arguments=True),
    "PAR": Command(_say(_parameter), arguments=True),
    "VAL": Command(_say(_read_variable), arguments=True),
    "VAL=": Command(_say(_write_variable), arguments=True),
    "HOT": Command(_say(_write_running), arguments=True),
    "LISTCNT": Command(_say(lambda _c, _a: "0000")),
    "PDIRTOP": Command(_nothing),
    "TIME": Command(_say(_time)),
    "IN": Command(_say(_input), arguments=True),
    "OUT": Command(_say(_output), arguments=True),
    "OUT=": Command(_say(_set_output), arguments=True),
    "HNDON": Command(_say(_hand), arguments=True),
    "HNDOFF": Command(_say(_hand), arguments=True),
}

_LONGEST_WORD = max(len(word) for word in COMMANDS)
