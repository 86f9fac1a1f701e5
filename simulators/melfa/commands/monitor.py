"""Clock and monitors (sheet, section 1.14).

Eight axes are answered, those that do not exist as 0. No source says how many pulses an encoder gives. Currents are 0
at rest and in proportion to the joint's speed in motion; temperatures and voltages are constant. A largest value is
that of all that were asked for since SVMONRST=, an RMS the present size.
"""

from collections.abc import Iterable, Sequence

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal
from catseye.simulators.melfa.commands.command import Client, Command, clock, nothing, say, show, whole
from catseye.simulators.melfa.controller import Controller

_AXES = 8
_ROBOT_AXES = 4
_BUS_VOLTAGE = 300
_RATED_CURRENT = 30.0
_TOLERABLE_CURRENT = 100.0
_MECHANISMS = "1"
_TEMPERATURE_C = 35
_BATTERY_HOURS = 14_000
_PULSES_A_TURN = 131_072
_SPEED_STEP_S = 1e-3


def _axes(values: Sequence[float], form: str = "d") -> str:
    padded = [*values, *[0] * (_AXES - len(values))]
    return ";".join(f"{value:{form}}" for value in padded)


def _groups(columns: Iterable[Sequence[float]], form: str = "d") -> str:
    """Return the values of each axis one after another, axis by axis."""
    rows = [*zip(*columns, strict=True)]
    rows += [(0,) * len(rows[0])] * (_AXES - len(rows))
    return ";".join(f"{value:{form}}" for row in rows for value in row)


def _largest(controller: Controller, name: str, values: Sequence[float]) -> list[float]:
    """Return the largest sizes of a quantity since the monitors were reset."""
    before = controller.largest_seen.get(name, (0.0,) * len(values))
    now = [max(abs(value), one) for value, one in zip(values, before, strict=True)]
    controller.largest_seen[name] = tuple(now)
    return now


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
    """Feedback, largest, command."""
    speeds = [100.0 * part for part in _speed_fractions(controller)]
    columns = (speeds, _largest(controller, "speed", speeds), speeds)
    return _groups([[round(value) for value in column] for column in columns])


def _currents(controller: Controller, arguments: str) -> str:
    """0: command, tolerable above and below, RMS; 1: feedback and two largest commands."""
    if not arguments:
        raise Refusal(alarms.ILLEGAL_COMMAND)
    kind = whole(arguments, 0, 1)
    currents = [_RATED_CURRENT * part for part in _speed_fractions(controller)]
    largest = _largest(controller, "current", currents)
    if kind:
        return _groups((currents, largest, largest), ".2f")
    above = [_TOLERABLE_CURRENT] * _ROBOT_AXES
    below = [-_TOLERABLE_CURRENT] * _ROBOT_AXES
    return _groups((currents, above, below, [abs(value) for value in currents]), ".2f")


def _load_currents(controller: Controller) -> str:
    """Load and largest load."""
    loads = [abs(_RATED_CURRENT * part) for part in _speed_fractions(controller)]
    return _groups((loads, _largest(controller, "load", loads)), ".2f")


def _voltages(controller: Controller) -> str:
    """Bus voltage, its largest and smallest, then the regeneration of each axis."""
    del controller
    return ";".join([str(_BUS_VOLTAGE)] * 3 + ["0"] * _AXES)


def _reset_largest(controller: Controller, arguments: str) -> str:
    del arguments
    controller.largest_seen.clear()
    return ""


def _hours(controller: Controller) -> str:
    """Power on, servo of all and of each of three mechanisms, twelve zeros, operation, 0, battery, mechanisms."""
    hours = int(controller.bench.time_s // 3600)
    servo = hours if controller.servo_on else 0
    fields = (hours, servo, servo, 0, 0, *[0] * 12, 0, 0, hours, _BATTERY_HOURS - hours)
    return ";".join([*map(str, fields), _MECHANISMS])


def _cycle_times(controller: Controller, arguments: str) -> str:
    return controller.memory.find(arguments).cycle_times


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
    "SRVVOL": Command(show(_voltages)),
    "SVMONRST=": Command(say(_reset_largest), arguments=True),
    "OPNUMRD": Command(show(lambda _: "1")),
    "OPSTSRD": Command(say(_ethernet), arguments=True, alone=True),
    "SLOTRD": Command(say(_slot_table), arguments=True, alone=True),
    "ENCBATTM": Command(show(lambda c: f"{int(c.bench.time_s // 3600)};{_BATTERY_HOURS}")),
}
