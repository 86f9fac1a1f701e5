"""Alarm numbers and this emulator's own texts for them (sheet, section 5.3; the vendor's texts are the vendor's)."""

HIGH, LOW, CAUTION = 1, 2, 3

EMERGENCY_STOP = 50
SERVO_OFF_UNEXPECTEDLY = 1681
SERVO_IS_OFF = 2000
DESTINATION_OUT_OF_RANGE = 2602
NO_SOLUTION = 2802
OUT_OF_RANGE = 3110
SYNTAX = 4220
NO_PROGRAM = 4140
UNDEFINED = 4340
DUPLICATE = 4350
NOTHING_SELECTED = 5100
SLOT_NOT_SELECTABLE = 5120
SERVO_ON_IMPOSSIBLE = 5130
BAD_ROBOT = 5430
ALARM_PRESENT = 5600
STOP_IS_ON = 5610
WHILE_RUNNING = 5640
ILLEGAL_COMMAND = 6010
NO_OPERATION_RIGHT = 6020
TOO_LONG = 6080

_TEXTS = {
    EMERGENCY_STOP: "Emergency stop input open",
    SERVO_OFF_UNEXPECTEDLY: "Servo went off unexpectedly",
    SERVO_IS_OFF: "Servo is off",
    DESTINATION_OUT_OF_RANGE: "Destination outside the joint limits",
    NO_SOLUTION: "Destination out of reach",
    OUT_OF_RANGE: "Value out of range",
    SYNTAX: "Statement not understood",
    NO_PROGRAM: "No such program",
    UNDEFINED: "Variable undefined",
    DUPLICATE: "Variable defined already",
    NOTHING_SELECTED: "No program selected",
    SLOT_NOT_SELECTABLE: "Slot not selectable",
    SERVO_ON_IMPOSSIBLE: "Servo cannot go on now",
    BAD_ROBOT: "No such robot",
    ALARM_PRESENT: "An alarm is present",
    STOP_IS_ON: "Stopped",
    WHILE_RUNNING: "Not while the robot moves",
    ILLEGAL_COMMAND: "Command not known",
    NO_OPERATION_RIGHT: "No operation right",
    TOO_LONG: "Command too long",
}

# Groups of the sheet whose alarms switch the servo off.
_HIGH_RANGES = ((50, 1629), (1680, 1769), (2130, 2199), (7810, 7849), (9000, 9099))
_CAUTION_RANGES = ((1630, 1679), (1770, 1779), (9200, 9299))


def level(number: int) -> int:
    """Return the level of an alarm: HIGH switches the servo off, LOW stops, CAUTION only warns."""
    if any(first <= number <= last for first, last in _HIGH_RANGES):
        return HIGH
    if any(first <= number <= last for first, last in _CAUTION_RANGES):
        return CAUTION
    return LOW


def text(number: int) -> str:
    """Return what an alarm means."""
    return _TEXTS.get(number, "Emulated alarm")


class Refusal(Exception):  # noqa: N818 - an answer of the controller, not a fault of the program
    """The controller rejects a request.

    Args:
        number: error number, four digits.
        detail: detail, five digits.
    """

    def __init__(self, number: int, detail: int = 0) -> None:
        super().__init__(f"{number:04d}-{detail:05d} {text(number)}")
        self.number = number
        self.detail = detail
