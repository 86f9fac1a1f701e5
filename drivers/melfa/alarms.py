"""What the alarms of MELFA controllers mean and what to do about them (sheet 5.3, own words)."""

from typing import NamedTuple


class Alarm(NamedTuple):
    """One entry of the table.

    Attributes:
        level: H high (servo off), L low (program stops), C caution.
        text: what it means.
        remedy: what to do.
    """

    level: str
    text: str
    remedy: str


_RELEASE = "remove the danger, release the button, then reset the alarm"
_PLAN = "check the target against the joint limits in the cell file and the parameter MEJAR"
_SERVO = "check key switch, emergency stop, door switch and pendant, reset the alarm and switch the servo on"
_ORIGIN = "set the origin as the robot's manual says; positions are not to be trusted before"

_SINGLE: dict[int, Alarm] = {
    50: Alarm("H", "external emergency stop", _RELEASE),
    51: Alarm("H", "wiring fault of the emergency stop circuit", "check both channels of the circuit"),
    60: Alarm("H", "emergency stop of the operating panel", _RELEASE),
    61: Alarm("H", "emergency stop of the operating panel", _RELEASE),
    70: Alarm("H", "emergency stop of the teaching pendant", _RELEASE),
    71: Alarm("H", "emergency stop of the teaching pendant", _RELEASE),
    75: Alarm(
        "H", "link to the teaching pendant lost", "plug the pendant in or set the controller to work without"
    ),
    1680: Alarm("H", "the servo did not come on in time", _SERVO),
    1681: Alarm("H", "the servo went off unexpectedly", _SERVO),
    1770: Alarm("C", "the origin setting is not complete", _ORIGIN),
    2000: Alarm("L", "the servo is off", "switch the servo on"),
    2140: Alarm("H", "an absolute position limit was passed", "jog the robot back into its range"),
    2160: Alarm(
        "H", "a joint limit was reached", "jog the joint back into its range, reset the alarm; " + _PLAN
    ),
    2600: Alarm("L", "position data outside of the range", _PLAN),
    2601: Alarm("L", "the motion starts outside of the range", "jog the robot back into its range"),
    2602: Alarm("L", "the target is outside of the range", _PLAN),
    2603: Alarm("L", "a via point is outside of the range", _PLAN),
    2800: Alarm("L", "no joint angles reach the position data", _PLAN),
    2801: Alarm("L", "no joint angles belong to the start of the motion", "jog the robot to another posture"),
    2802: Alarm("L", "no joint angles reach the target", _PLAN),
    2803: Alarm("L", "no joint angles reach a via point", _PLAN),
    2804: Alarm("L", "a singular point lies on the path", "go by joint interpolation"),
    2810: Alarm("L", "the posture flags disagree", "give the target the flags of the start"),
    3110: Alarm("L", "an argument is outside of its range", "check the value in the command"),
    3120: Alarm(
        "L", "wrong number of arguments", "check the command; the robot may have other axes than expected"
    ),
    3280: Alarm(
        "L", "the slot does not hold the mechanism", "use slot 1 or release the mechanism in the other slot"
    ),
    3700: Alarm("L", "undefined variable", "connect again, which declares the variable again"),
    3810: Alarm("L", "wrong type of argument", "check that no program uses a variable JCATSEY1 to JCATSEY8"),
    3860: Alarm("L", "illegal position data", "check the values in the command"),
    4140: Alarm("L", "no such program", "select a program that exists"),
    4220: Alarm("L", "syntax error in a statement", "check that the firmware knows the statement"),
    4340: Alarm("L", "the variable is not defined", "connect again, which declares the variable again"),
    4350: Alarm("L", "the variable is defined already", "nothing: the definition that is there is used"),
    5000: Alarm("H", "the pendant is enabled in AUTO", "switch the pendant's enable switch off"),
    5010: Alarm("L", "automatic operation is not enabled", "set the AUTOENA input"),
    5110: Alarm("L", "another program is paused", "reset the program at the operating panel"),
    5120: Alarm("L", "the slot cannot be selected", "stop and reset the running program"),
    5130: Alarm("L", "the servo cannot be switched on now", _SERVO),
    5150: Alarm("L", "the origin is not set", _ORIGIN),
    5420: Alarm("L", "no such slot", "check the setting slot in the cell file"),
    5430: Alarm("L", "no such robot", "check the setting robot_number in the cell file"),
    5600: Alarm("L", "an alarm is active", "read and reset it first"),
    5610: Alarm("C", "a STOP signal is on", "release STOPON, the stop input or the pendant's stop"),
    5620: Alarm("L", "cycle stop is on", "release the cycle stop"),
    5630: Alarm("L", "the servo-off signal is on", "release the servo-off input"),
    5640: Alarm("L", "not possible while running", "wait for the end of the program or stop it"),
    6010: Alarm(
        "L",
        "the controller does not know the command",
        "check firmware and port; without EXEC2 set motion = 'exec'",
    ),
    6020: Alarm(
        "L", "no operation right", "end other programs that control the robot, key to AUTO, pendant disabled"
    ),
    6030: Alarm("L", "no right to edit", "close the program that is being edited"),
    6050: Alarm("C", "a file cannot be accessed", "check that it exists and is not in use"),
    6060: Alarm("C", "the key is not at TEACH", "turn the key to TEACH"),
    6080: Alarm("C", "a message is too long", "check that nothing else writes to the port"),
    6130: Alarm("L", "network error", "check the controller's network parameters"),
    6500: Alarm("C", "a communication line is not open", "start the program that opens the line"),
    6600: Alarm("L", "no such signal", "check the signal number"),
    7810: Alarm("H", "wrong network parameters", "check the NETIP family of parameters"),
    7820: Alarm("H", "real-time control timed out", "check the network load; restart the real-time control"),
    7830: Alarm("H", "real-time control failed", "restart the real-time control"),
    7840: Alarm("H", "illegal real-time packet", "check that both sides use the same data types"),
}

_FAMILIES: dict[int, Alarm] = {
    83: Alarm(
        "H", "overload family of the servo amplifier", "let it cool down, lower speed and acceleration"
    ),
    87: Alarm(
        "H", "overload family of the servo amplifier", "let it cool down, lower speed and acceleration"
    ),
    91: Alarm(
        "H", "overload family of the servo amplifier", "check load and mechanics, lower the acceleration"
    ),
    93: Alarm(
        "H", "overload family of the servo amplifier", "check load and mechanics, lower the acceleration"
    ),
    94: Alarm(
        "H", "overload family of the servo amplifier", "check load and mechanics, lower the acceleration"
    ),
    95: Alarm(
        "H", "overload family of the servo amplifier", "check load and mechanics, lower the acceleration"
    ),
    96: Alarm("H", "excessive following error", "check for a collision and the load, lower the acceleration"),
    97: Alarm("H", "excessive following error", "check for a collision and the load, lower the acceleration"),
    98: Alarm("H", "excessive following error", "check for a collision and the load, lower the acceleration"),
    182: Alarm("L", "position data disagree", _ORIGIN),
    213: Alarm("H", "over-speed", "lower the speed override"),
    214: Alarm("H", "absolute position limit passed upwards", "jog the joint back into its range"),
    215: Alarm("H", "absolute position limit passed downwards", "jog the joint back into its range"),
    216: Alarm(
        "H", "joint limit reached upwards", "jog the joint back into its range, reset the alarm; " + _PLAN
    ),
    217: Alarm(
        "H", "joint limit reached downwards", "jog the joint back into its range, reset the alarm; " + _PLAN
    ),
    218: Alarm(
        "H", "XYZ limit reached upwards", "jog the robot back into its range; check the parameter MEPAR"
    ),
    219: Alarm(
        "H", "XYZ limit reached downwards", "jog the robot back into its range; check the parameter MEPAR"
    ),
}

_RANGES: tuple[tuple[int, int, Alarm], ...] = (
    (1630, 1670, Alarm("C", "the servo cannot be switched on", _SERVO)),
    (9000, 9099, Alarm("H", "alarm raised by a program in the controller", "see that program")),
    (9100, 9199, Alarm("L", "alarm raised by a program in the controller", "see that program")),
    (9200, 9299, Alarm("C", "alarm raised by a program in the controller", "see that program")),
)

_LEVELS = {
    1: Alarm(
        "H",
        "alarm of level high, the servo is off",
        "see the controller's troubleshooting manual, then reset",
    ),
    2: Alarm(
        "L", "alarm of level low, the program has stopped", "see the controller's troubleshooting manual"
    ),
    3: Alarm("C", "caution, operation goes on", "see the controller's troubleshooting manual"),
}
_UNKNOWN = Alarm("", "alarm that is not in the table", "see the controller's troubleshooting manual")
_XYZ_FAMILIES = {218, 219}


STOP_IS_ON = 5610
"""A STOP signal is on; also the rejection that ends a motion which STOP interrupts."""

NOT_READY = frozenset(
    {50, 51, 60, 61, 70, 71, 75, 1680, 1681, 2000, 5000, 5130, STOP_IS_ON, 5630, 6020, 6060}
)
"""Rejections that end when somebody at the cell has acted: emergency stop, drives, mode, STOP, right."""

NOT_UNDERSTOOD = frozenset({5420, 5430, 6010})
"""Rejections of a slot, robot or command that does not exist: of requests, too, that were garbled on their way."""


def describe(number: int, level: int = 0) -> str:
    """Return what an alarm means and what to do.

    Args:
        level: as the controller gives it: 1 H, 2 L, 3 C; 0 when unknown.

    Returns:
        For 2165: "alarm H2165: joint limit reached upwards, J5; jog ...".
    """
    alarm, axis = _look_up(number, level)
    return f"alarm {alarm.level}{number:04d}: {alarm.text}{axis}; {alarm.remedy}"


def _look_up(number: int, level: int) -> tuple[Alarm, str]:
    """Return the entry and the axis, if the last digit is one."""
    if number in _SINGLE:
        return _SINGLE[number], ""
    family, digit = divmod(number, 10)
    if family in _FAMILIES:
        axis = f"{'?XYZ'[digit]}" if family in _XYZ_FAMILIES and 1 <= digit <= 3 else f"J{digit}"
        return _FAMILIES[family], f", {axis}" if digit else ""
    for first, last, alarm in _RANGES:
        if first <= number <= last:
            return alarm, ""
    return _LEVELS.get(level, _UNKNOWN), ""
