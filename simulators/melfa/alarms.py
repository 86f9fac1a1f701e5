"""Alarm numbers and this emulator's own texts for them (sheet, section 5.3; the vendor's texts are the vendor's)."""

HIGH, LOW, CAUTION = 1, 2, 3

EMERGENCY_STOP = 50
SERVO_OFF_UNEXPECTEDLY = 1681
SERVO_IS_OFF = 2000
DESTINATION_OUT_OF_RANGE = 2602
VIA_OUT_OF_RANGE = 2603
NO_SOLUTION = 2802
OTHER_POSTURE = 2810
OUT_OF_RANGE = 3110
COUNT = 3120
BAD_INPUT = 3500
LINE_TOO_LONG = 4210
SYNTAX = 4220
NO_PROGRAM = 4140
UNDEFINED = 4340
DUPLICATE = 4350
NOT_EDITING = 4820
PENDANT_ENABLED = 5000
START_DISABLED = 5010
NOTHING_SELECTED = 5100
PROGRAM_PAUSED = 5110
SLOT_NOT_SELECTABLE = 5120
SERVO_ON_IMPOSSIBLE = 5130
BAD_ROBOT = 5430
ALARM_PRESENT = 5600
STOP_IS_ON = 5610
WHILE_RUNNING = 5640
ILLEGAL_COMMAND = 6010
NO_OPERATION_RIGHT = 6020
NO_EDIT_RIGHT = 6030
FILE = 6050
TOO_LONG = 6080
NETWORK = 6130
BAD_SIGNAL = 6600
MXT_TIMEOUT = 7820
MXT_PACKET = 7840
OVER_SPEED = 2130
JOINT_LIMIT_ABOVE = 2160
JOINT_LIMIT_BELOW = 2170

OUT_OF_REACH = range(2600, 2820)
"""Motions that a program asks for and the arm cannot make; an alarm of low level."""

_TEXTS = {
    EMERGENCY_STOP: "Emergency stop input open",
    SERVO_OFF_UNEXPECTEDLY: "Servo went off unexpectedly",
    SERVO_IS_OFF: "Servo is off",
    DESTINATION_OUT_OF_RANGE: "Destination outside the joint limits",
    VIA_OUT_OF_RANGE: "The way leaves the joint limits",
    NO_SOLUTION: "Destination out of reach",
    OTHER_POSTURE: "The destination has another posture",
    OUT_OF_RANGE: "Value out of range",
    COUNT: "Too many values",
    BAD_INPUT: "Input is not what the program reads",
    LINE_TOO_LONG: "Line too long",
    SYNTAX: "Statement not understood",
    NO_PROGRAM: "No such program",
    UNDEFINED: "Variable undefined",
    DUPLICATE: "Variable defined already",
    NOT_EDITING: "No program open for editing",
    PENDANT_ENABLED: "Pendant or TEACH has the control",
    START_DISABLED: "Start is disabled",
    NOTHING_SELECTED: "No program selected",
    PROGRAM_PAUSED: "A program is paused",
    SLOT_NOT_SELECTABLE: "Slot not selectable",
    SERVO_ON_IMPOSSIBLE: "Servo cannot go on now",
    BAD_ROBOT: "No such robot",
    ALARM_PRESENT: "An alarm is present",
    STOP_IS_ON: "Stopped",
    WHILE_RUNNING: "Not while the robot moves",
    ILLEGAL_COMMAND: "Command not known",
    NO_OPERATION_RIGHT: "No operation right",
    NO_EDIT_RIGHT: "Another client edits",
    FILE: "File not accessible",
    TOO_LONG: "Command too long",
    NETWORK: "Network connection cannot be opened",
    BAD_SIGNAL: "No such signal",
    MXT_TIMEOUT: "Real-time control hears nothing",
    MXT_PACKET: "Real-time control does not understand a packet",
    OVER_SPEED: "An axis is too fast",
    JOINT_LIMIT_ABOVE: "Upper limit of an axis",
    JOINT_LIMIT_BELOW: "Lower limit of an axis",
    **{OVER_SPEED + axis: f"J{axis} too fast" for axis in range(1, 9)},
    **{JOINT_LIMIT_ABOVE + axis: f"Upper limit of J{axis}" for axis in range(1, 9)},
    **{JOINT_LIMIT_BELOW + axis: f"Lower limit of J{axis}" for axis in range(1, 9)},
}

# Groups of the sheet whose alarms switch the servo off.
_HIGH_RANGES = ((50, 1629), (1680, 1769), (2130, 2199), (5000, 5000), (7810, 7849), (9000, 9099))
_CAUTION_RANGES = ((1630, 1679), (1770, 1779), (5610, 5610), (6050, 6089), (6500, 6500), (9200, 9299))


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


class Refusal(Exception):  # noqa: N818  # an answer of the controller, not a fault of the program
    """The controller rejects a request.

    Args:
        number: error number, four digits.
        detail: detail, five digits.
        place: where an edited line is wrong, `;position` or `;line;position`; only editing commands give it.
    """

    def __init__(self, number: int, detail: int = 0, place: str = "") -> None:
        super().__init__(f"{number:04d}-{detail:05d} {text(number)}")
        self.number = number
        self.detail = detail
        self.place = place
