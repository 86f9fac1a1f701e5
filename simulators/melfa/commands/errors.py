"""Errors and their log (sheet, section 1.13).

ERRORLOGTOP is the latest line. ERRLOG2 takes the same words, then a level and a detail that lines have to have;
either may be empty.
"""

from collections import Counter

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.arm_control import LogLine
from catseye.simulators.melfa.commands.command import (
    Client,
    Command,
    clock,
    do,
    place_in,
    required_number,
    say,
    show,
    whole,
)
from catseye.simulators.melfa.controller import Controller

_LARGEST, _DETAILS = 9999, 100_000
_LARGEST_WITH_DETAIL = _LARGEST * _DETAILS + _DETAILS - 1
_LETTERS = {alarms.HIGH: "H", alarms.LOW: "L", alarms.CAUTION: "C"}


def _error(controller: Controller) -> str:
    number = controller.alarm_shown
    return f"{number};{alarms.level(number)}" if number else ""


def _error_text(controller: Controller, arguments: str) -> str:
    """Explain a number of four digits, or of nine with the detail, as refusals have it."""
    del controller
    number = int(required_number(arguments))
    if not 0 <= number <= _LARGEST_WITH_DETAIL:
        raise Refusal(alarms.OUT_OF_RANGE)
    return alarms.text(number // _DETAILS if number > _LARGEST else number)


def _log(controller: Controller, client: Client, arguments: str) -> str:
    return _line(client, arguments, list(reversed(controller.log)))


def _filtered_log(controller: Controller, client: Client, arguments: str) -> str:
    which, level, detail = [*arguments.split(";"), "", ""][:3]
    wanted = whole(level, 0, 3) if level else 0
    lines = [
        line
        for line in reversed(controller.log)
        if wanted in {0, alarms.level(line.number)} and (not detail or detail == _detail(line.number))
    ]
    return _line(client, which, lines)


def _line(client: Client, which: str, lines: list[LogLine]) -> str:
    place = place_in(client, "log", which, len(lines))
    if place is None:
        return ""
    line = lines[place]
    letter, when = _LETTERS[alarms.level(line.number)], clock(line.time_s, "%y-%m-%d;%H:%M:%S")
    return f"{when};{line.number};{alarms.text(line.number)};{letter};;0;{_detail(line.number)}"


def _clear_log(controller: Controller, arguments: str) -> str:
    level = whole(arguments, 0, 3)
    kept = [line for line in controller.log if level and alarms.level(line.number) != level]
    controller.log.clear()
    controller.log.extend(kept)
    return ""


def _summary(controller: Controller, arguments: str, *, dated: bool = False) -> str:
    """Return the n-th most frequent alarm of the log, the first one being 1."""
    counted = Counter(line.number for line in controller.log).most_common()
    place = whole(arguments, 1, 9999)
    if place > len(counted):
        return f"{len(counted)};000000000;;;;;0"
    number, times = counted[place - 1]
    letter = _LETTERS[alarms.level(number)]
    text = f"{len(counted)};{_detail(number)};{letter};{alarms.text(number)};;;{times}"
    last_s = max(line.time_s for line in controller.log if line.number == number)
    return f"{text};{clock(last_s, '%y-%m-%d;%H:%M:%S')}" if dated else text


def _detail(number: int) -> str:
    return f"{number:04d}00000"


COMMANDS = {
    "ERROR": Command(show(_error)),
    "ERRORMES": Command(say(_error_text), arguments=True),
    "ERRORLOG": Command(_log, arguments=True),
    "ERRLOG2=": Command(_filtered_log, arguments=True),
    "ERRLOGCLR": Command(say(_clear_log), arguments=True),
    "ERRSUM": Command(say(_summary), arguments=True),
    "ERRSUM2=": Command(say(lambda c, a: _summary(c, a, dated=True)), arguments=True),
    "ERRSUMCLR": Command(do(lambda c: c.log.clear())),
}
