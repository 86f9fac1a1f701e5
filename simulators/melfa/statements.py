"""Statements of direct execution (`EXEC…`, `EXEC2=…`) and variables (sheet, sections 1.9, 1.14 and 4.2).

Straight and circular motions (MVS, MVR, MVC) go along their ways at the speed of SPD; see `paths`. TOOL and BASE
change what positions mean; see `frames`. FINE, CNT, OADL and TORQ are accepted and have no effect.
"""

import math
import re
from collections.abc import Callable
from dataclasses import replace

from catseye.simulators.config import Joints
from catseye.simulators.melfa import alarms, expressions, frames, paths
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import ArmControl, Run
from catseye.simulators.melfa.signals import signal_number
from catseye.simulators.melfa.values import (
    RIGHT,
    Position,
    Variable,
    joint_constant,
    position_constant,
)
from catseye.simulators.world.types import Floats

_NAME = re.compile(r"[JPM][A-Z0-9_]{0,15}")
_ASSIGNMENT = re.compile(r"([JPM][A-Z0-9_]{0,15})\s*=\s*(.+)")
_DEFINITION = re.compile(r"(JNT|POS|INTE|LONG|FLOAT|DOUBLE)\s+([A-Z][A-Z0-9_]{0,15})")
_CONSTANT = re.compile(r"([JP]?)\(([^()]*)\)\s*(?:\(([^()]*)\))?")
_SUM = re.compile(r"(P[A-Z0-9_]*)\s*\+\s*(\([^()]*\)\s*(?:\([^()]*\))?)")
_SIGNAL = re.compile(r"(M_IN|M_OUT)\((\d{1,5})\)")
_OUTPUT = re.compile(r"M_OUT\s*\((.+?)\)\s*=\s*(.+)")
_WORD = re.compile(r"([A-Z]+)\b\s*(.*)")
LAST_TOOL = 16
"""Largest number of a tool (sheet, section 1.9)."""

_LARGEST_STORE = 500
_NOWHERE_MM = 1e-3
_LONGEST_DELAY_S = 3600.0


def execute(controller: ArmControl, statement: str) -> Run | None:
    """Carry out one statement; keywords and names may be in either case.

    Returns:
        The motion that it started, None when it is done.

    Raises:
        Refusal: the statement is not understood or cannot be carried out.
    """
    text = statement.strip().upper()
    if (found := _OUTPUT.fullmatch(text)) is not None:
        _switch(controller, value_of(controller, found[1]), value_of(controller, found[2]))
        return None
    if (found := _ASSIGNMENT.fullmatch(text)) is not None:
        assign(controller, found[1], found[2])
        return None
    word = _WORD.fullmatch(text)
    if word is None or word[1] not in _STATEMENTS:
        raise Refusal(alarms.SYNTAX)
    return _STATEMENTS[word[1]](controller, word[2].strip())


def assign(controller: ArmControl, name: str, value: str) -> None:
    """Give a variable a value; the first letter of its name is its type."""
    if _NAME.fullmatch(name) is None:
        raise Refusal(alarms.SYNTAX)
    if name in _STATUS and name not in _SETTERS:
        raise Refusal(controller.choices.read_only_number)
    new = value_of(controller, value) if name[0] == "M" else _operand(controller, value, name[0])
    if (name[0] == "P") != isinstance(new, Position):
        raise Refusal(alarms.SYNTAX)
    if name in _SETTERS:
        _SETTERS[name](controller, new)
    else:
        _store(controller, name, new)


def read(controller: ArmControl, name: str) -> Variable:
    """Return the value of a variable, a status variable or a signal.

    Raises:
        Refusal: there is none of that name.
    """
    if (found := _SIGNAL.fullmatch(name)) is not None:
        return _signal(controller, found[1], int(found[2]))
    status = _STATUS.get(name)
    if status is not None:
        return status(controller)
    if name not in controller.variables:
        raise Refusal(alarms.UNDEFINED)
    return controller.variables[name]


def _store(controller: ArmControl, name: str, value: Variable) -> None:
    if name not in controller.variables and len(controller.variables) >= _LARGEST_STORE:
        raise Refusal(alarms.OUT_OF_RANGE)
    controller.variables[name] = value


def value_of(controller: ArmControl, text: str) -> float:
    """Return the value of a numeric expression or condition.

    Raises:
        Refusal: it is none, or a name in it has no number.
    """

    def lookup(name: str, index: int | None) -> float:
        if index is not None:
            return _signal(controller, name, index)
        value = read(controller, name)
        if not isinstance(value, int | float):
            raise Refusal(alarms.SYNTAX)
        return float(value)

    return expressions.evaluate(text, lookup)


def _signal(controller: ArmControl, name: str, index: int) -> float:
    signals = controller.signals
    if name not in {"M_IN", "M_OUT"}:
        raise Refusal(alarms.SYNTAX)
    return float(signal_number(str(index)) in (signals.inputs if name == "M_IN" else signals.outputs))


def _switch(controller: ArmControl, index: float, value: float) -> None:
    signal = signal_number(str(int(index)))
    if value not in {0.0, 1.0}:
        raise Refusal(alarms.OUT_OF_RANGE)
    (controller.signals.outputs.add if value else controller.signals.outputs.discard)(signal)


def _operand(controller: ArmControl, text: str, kind: str = "") -> Joints | Position:
    """Return the value of a name, of a sum or of a constant; kind, J or P, says what a constant is."""
    if _NAME.fullmatch(text) is not None:
        value = read(controller, text)
        if isinstance(value, int | float):
            raise Refusal(alarms.SYNTAX)
        return value
    if (added := _SUM.fullmatch(text)) is not None:
        base, shift = _operand(controller, added[1]), constant(controller, added[2], "P")
        if isinstance(base, Position) and isinstance(shift, Position):
            return _added(base, shift)
    return constant(controller, text, kind)


def _added(base: Position, shift: Position) -> Position:
    return replace(
        base,
        x_mm=base.x_mm + shift.x_mm,
        y_mm=base.y_mm + shift.y_mm,
        z_mm=base.z_mm + shift.z_mm,
        c_deg=base.c_deg + shift.c_deg,
    )


def constant(controller: ArmControl, text: str, kind: str) -> Joints | Position:
    """Return the value of a constant `(…)` or `(…)(…)`; kind, J or P, says what it is; without one its form does."""
    found = _CONSTANT.fullmatch(text)
    if found is None:
        raise Refusal(alarms.SYNTAX)
    kind, values, flags = found[1] or kind, found[2], found[3]
    # Four values without flags are joints of this arm; a position of it has six places.
    joints = kind == "J" or (not kind and flags is None and values.count(",") < 4)
    if joints:
        return joint_constant(values)
    return position_constant(values, flags, controller.position().flag1)


def _move(controller: ArmControl, target: str) -> Run:
    return controller.move(_operand(controller, target))


def _straight(controller: ArmControl, target: str) -> Run:
    end = _place(controller, target)
    here = controller.position()
    if _distance_mm(here, end) < _NOWHERE_MM:
        # The tool turns, or nothing moves: neither has a speed along a way.
        return controller.move(end)
    _require_posture(here, end)
    return controller.move_along(paths.line(here, end))


def _arc(controller: ArmControl, text: str) -> Run:
    start, via, end = _three(controller, text)
    _require_posture(controller.position(), end)
    return controller.move_along(*_to_start(controller, start), paths.arc(start, via, end))


def _circle(controller: ArmControl, text: str) -> Run:
    start, first, second = _three(controller, text)
    return controller.move_along(*_to_start(controller, start), paths.circle(start, first, second))


def _three(controller: ArmControl, text: str) -> tuple[Position, Position, Position]:
    """Return the three places of an arc or circle, between commas outside of brackets."""
    places = [_place(controller, part.strip()) for part in re.split(r",(?![^()]*\))", text)]
    if len(places) != 3:
        raise Refusal(alarms.SYNTAX)
    return places[0], places[1], places[2]


def _to_start(controller: ArmControl, start: Position) -> list[Floats]:
    """Return the straight way to where an arc begins; none where the tool is there."""
    here = controller.position()
    _require_posture(here, start)
    return [] if _distance_mm(here, start) < _NOWHERE_MM else [paths.line(here, start)]


def _place(controller: ArmControl, text: str) -> Position:
    """Return a position; that of joints is where they bring the tool."""
    value = _operand(controller, text)
    return value if isinstance(value, Position) else controller.position_of(value)


def _distance_mm(one: Position, other: Position) -> float:
    return math.dist((one.x_mm, one.y_mm, one.z_mm), (other.x_mm, other.y_mm, other.z_mm))


def _require_posture(here: Position, end: Position) -> None:
    """Refuse another posture: no straight way leads there."""
    if (here.flag1 ^ end.flag1) & RIGHT:
        raise Refusal(alarms.OTHER_POSTURE)


def _define(controller: ArmControl, text: str) -> None:
    found = _DEFINITION.fullmatch(text)
    if found is None:
        raise Refusal(alarms.SYNTAX)
    kind, name = found[1], found[2]
    if name in controller.variables or name in _STATUS:
        raise Refusal(alarms.DUPLICATE)
    values: dict[str, Variable] = {"JNT": (0.0, 0.0, 0.0, 0.0), "POS": Position(0.0, 0.0, 0.0, 0.0, 0)}
    _store(controller, name, values.get(kind, 0.0))


def _figure(controller: ArmControl, text: str) -> float:
    """Return the figure behind a word; a word without one is out of its range."""
    if not text:
        raise Refusal(alarms.OUT_OF_RANGE)
    return value_of(controller, text)


def _percent(controller: ArmControl, text: str) -> float:
    value = _figure(controller, text)
    if not 0.0 < value <= 100.0:
        raise Refusal(alarms.OUT_OF_RANGE)
    return value


def _override(controller: ArmControl, text: str) -> None:
    controller.program_override_percent = _percent(controller, text)


def _joint_override(controller: ArmControl, text: str) -> None:
    controller.joint_override_percent = _percent(controller, text)


def _linear_speed(controller: ArmControl, text: str) -> None:
    value = _figure(controller, text)
    if not 0.0 < value <= 10_000.0:
        raise Refusal(alarms.OUT_OF_RANGE)
    controller.linear_speed_mm_s = value


def _accel(controller: ArmControl, text: str) -> None:
    # Acceleration and deceleration are one figure here: the gentler one.
    values = [_percent(controller, part.strip()) for part in text.split(",")] if text else [100.0]
    controller.accel_percent = min(values)


def _delay(controller: ArmControl, text: str) -> Run:
    seconds = _figure(controller, text)
    if not 0.0 < seconds <= _LONGEST_DELAY_S:
        raise Refusal(alarms.OUT_OF_RANGE)
    return controller.wait(seconds)


def _servo(controller: ArmControl, text: str) -> None:
    if text == "ON":
        controller.switch_servo_on()
    elif text == "OFF":
        controller.switch_servo_off()
    else:
        raise Refusal(alarms.SYNTAX)


def _tool(controller: ArmControl, text: str) -> None:
    controller.frames.tool = _frame(controller, text)


def _base(controller: ArmControl, text: str) -> None:
    controller.frames.base = _frame(controller, text)


def _frame(controller: ArmControl, text: str) -> Position:
    """Return the data of a tool or base; posture flags do not belong to it."""
    value = _operand(controller, text, "P")
    if not isinstance(value, Position):
        raise Refusal(alarms.SYNTAX)
    return replace(value, flag1=0, flag2=0)


def _select_tool(controller: ArmControl, number: Variable) -> None:
    """Choose the number of the tool, 0 to LAST_TOOL; what TOOL has set stays."""
    if not isinstance(number, int | float) or number not in range(LAST_TOOL + 1):
        raise Refusal(alarms.OUT_OF_RANGE)
    controller.tool = int(number)


def _accept(controller: ArmControl, text: str) -> None:
    """Take a statement that changes nothing that is modelled."""
    del controller, text


_STATEMENTS: dict[str, Callable[[ArmControl, str], Run | None]] = {
    "MOV": _move,
    "MVS": _straight,
    "MVR": _arc,
    "MVC": _circle,
    "DEF": _define,
    "OVRD": _override,
    "JOVRD": _joint_override,
    "SPD": _linear_speed,
    "ACCEL": _accel,
    "SERVO": _servo,
    "DLY": _delay,
    "TOOL": _tool,
    "BASE": _base,
    **dict.fromkeys(("END", "HOPEN", "HCLOSE", "FINE", "CNT", "OADL", "TORQ"), _accept),
}


def _encoder_pulses(controller: ArmControl) -> Joints:
    per_unit = controller.choices.pulses_per_unit
    j1, j2, j3, j4 = (float(round(joint * per_unit)) for joint in controller.bench.measured)
    return (j1, j2, j3, j4)


# Of the program's variable; ERROR counts the other way round. From memory of the language, not from a source at hand.
_ERROR_LEVELS = {alarms.CAUTION: 1, alarms.LOW: 2, alarms.HIGH: 3}

_STATUS: dict[str, Callable[[ArmControl], Variable]] = {
    "M_SVO": lambda c: float(c.servo_on),
    "M_OVRD": lambda c: c.program_override_percent,
    "M_OPOVRD": lambda c: c.override_percent,
    "M_JOVRD": lambda c: c.joint_override_percent,
    "M_SPD": lambda c: c.linear_speed_mm_s,
    "M_RSPD": lambda c: abs(c.tool_speed_mm_s()),
    "M_NOVRD": lambda _c: 100.0,
    "M_NJOVRD": lambda _c: 100.0,
    "M_NSPD": lambda _c: 10_000.0,
    "M_TOOL": lambda c: float(c.tool),
    "M_ERR": lambda c: float(c.alarm != 0),
    "M_ERRNO": lambda c: float(c.alarm),
    "M_ERRLVL": lambda c: float(_ERROR_LEVELS[alarms.level(c.alarm)] if c.alarm else 0),
    "M_FBD": lambda c: _distance_mm(c.position(), c.position_of(c.bench.measured)),
    "P_TOOL": lambda c: c.frames.tool,
    "P_BASE": lambda c: c.frames.base,
    "P_NTOOL": lambda _c: frames.NONE,
    "P_NBASE": lambda _c: frames.NONE,
    "J_CURR": lambda c: c.shown_joints,
    # The encoders sit before the gears: feedback shows nothing of the arm's deviation behind them.
    "J_FBC": lambda c: c.feedback,
    "J_ECURR": _encoder_pulses,
    "P_CURR": lambda c: c.position_of(c.shown_joints),
    "P_FBC": lambda c: c.position_of(c.feedback),
}

_SETTERS: dict[str, Callable[[ArmControl, Variable], None]] = {"M_TOOL": _select_tool}
"""Status variables that a program may write; every other one is refused."""
