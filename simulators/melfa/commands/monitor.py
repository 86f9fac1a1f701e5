"""Clock and monitors (sheet, section 1.14).

Eight axes are answered, those that do not exist as 0. No source says how many pulses an encoder gives, nor the
layout of PTIME (here: hours of power, servo and operation) and CYCLETIME (here: last, average, cycles). Currents
are 0 at rest and in proportion to the joint's speed in motion; temperatures and voltages are constant.
"""

from catseye.simulators.melfa.commands.command import Client, Command, clock, nothing, say, show, whole
from catseye.simulators.melfa.controller import Controller

_AXES = 8
_ROBOT_AXES = 4
_BUS_VOLTAGE = 300
_TEMPERATURE_C = 35
_BATTERY_HOURS = 14_000
_PULSES_A_TURN = 131_072
_SPEED_STEP_S = 1e-3


def _axes(values: list[float] | list[int], form: str = "d") -> str:
    padded = [*values, *[0] * (_AXES - len(values))]
    return ";".join(f"{value:{form}}" for value in padded)


def _pulses(controller: Controller) -> list[int]:
    return [round(joint * controller.choices.pulses_per_unit) for joint in controller.bench.measured]


def _encoders(controller: Controller) -> str:
    """Feedback, place within one turn, feedback without filter, command; the drives follow exactly at rest."""
    groups = [f"{p};{p % _PULSES_A_TURN};{p};{p}" for p in _pulses(controller)]
    return ";".join([*groups, *["0;0;0;0"] * (_AXES - _ROBOT_AXES)])


def _speed_fractions(controller: Controller) -> list[float]:
    """Return each joint's speed in parts of its largest."""
    now, later = controller.bench.joints, controller.bench.joints_at(controller.bench.time_s + _SPEED_STEP_S)
    largest = controller.config.dynamics.max_speed
    return [(b - a) / _SPEED_STEP_S / most for a, b, most in zip(now, later, largest, strict=True)]


def _speeds(controller: Controller) -> str:
    return _axes([round(100 * part) for part in _speed_fractions(controller)])


def _currents(controller: Controller, arguments: str) -> str:
    whole(arguments or "0", 0, 1)
    return _axes([30.0 * part for part in _speed_fractions(controller)], ".2f")


def _load_currents(controller: Controller) -> str:
    return _axes([abs(30.0 * part) for part in _speed_fractions(controller)], ".2f")


def _hours(controller: Controller) -> str:
    hours = int(controller.bench.time_s // 3600)
    return f"{hours};{hours if controller.servo_on else 0};0"


def _cycle_times(controller: Controller, arguments: str) -> str:
    program = controller.memory.find(arguments)
    average_s = program.total_s / program.cycles if program.cycles else 0.0
    return f"{1e3 * program.last_s:.0f};{1e3 * average_s:.0f};{program.cycles}"


def _ethernet(controller: Controller, arguments: str) -> str:
    """Return the Ethernet interface in words; connections are not counted here."""
    del arguments
    whole_address = controller.parameters.read("NETIP").split(";")[1]
    ports = controller.parameters.read("NETPORT").split(";")[1].split(", ")
    lines = ";".join(f"OPT{11 + n}={port},0" for n, port in enumerate(ports[1:]))
    return f"Ethernet;IP={whole_address};RT={ports[0]};{lines}"


def _slot_table(controller: Controller, arguments: str) -> str:
    del arguments
    return f"{controller.task.program};{'REP' if controller.task.repeat else 'CYC'};START;1"


def _date(controller: Controller, client: Client, arguments: str) -> str:
    del client, arguments
    return clock(controller.bench.time_s, "%y-%m-%d%H:%M:%S")


COMMANDS = {
    "TIME": Command(_date),
    "TIME=": Command(nothing, arguments=True),
    "PTIME": Command(show(_hours)),
    "CYCLETIME": Command(say(_cycle_times), arguments=True),
    "THMRD": Command(show(lambda _: f"{_TEMPERATURE_C}")),
    # The encoders' temperatures now, then their largest.
    "ETEMP": Command(show(lambda _: ";".join([_axes([_TEMPERATURE_C] * _ROBOT_AXES)] * 2))),
    "EMISS": Command(show(lambda _: _axes([]))),
    "SRVENC": Command(show(_encoders)),
    "SRVDRP": Command(show(lambda _: ";".join(["0;0"] * _AXES))),
    "SRVSPD": Command(show(_speeds)),
    "SRVCUR": Command(say(_currents), arguments=True),
    "SRVLCR": Command(show(_load_currents)),
    "SRVVOL": Command(show(lambda _: _axes([_BUS_VOLTAGE] * _ROBOT_AXES))),
    "SVMONRST=": Command(nothing, arguments=True),
    "OPNUMRD": Command(show(lambda _: "1")),
    "OPSTSRD": Command(say(_ethernet), arguments=True),
    "SLOTRD": Command(say(_slot_table), arguments=True),
    "ENCBATTM": Command(show(lambda c: f"{int(c.bench.time_s // 3600)};{_BATTERY_HOURS}")),
}
