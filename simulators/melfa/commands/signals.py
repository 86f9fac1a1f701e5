"""Signals, hands, stop sources (sheet, section 1.12)."""

from catseye.simulators.melfa.commands.command import Command, say, show
from catseye.simulators.melfa.controller import Controller
from catseye.simulators.melfa.signals import WORD, hexadecimal, register_number, signal_number, word

_FIRST_HAND_SIGNAL = 900
_OPEN, _CLOSED = 1, 2


def _both(controller: Controller, arguments: str) -> str:
    first, _, second = arguments.partition(";")
    signals = controller.signals
    inputs, outputs = word(signals.inputs, signal_number(first)), word(signals.outputs, signal_number(second))
    return f"{inputs:04X}{outputs:04X}"


def _write_outputs(controller: Controller, arguments: str) -> str:
    first, _, bits = arguments.partition(";")
    controller.signals.write_outputs(signal_number(first), hexadecimal(bits))
    return ""


def _write_inputs(controller: Controller, arguments: str) -> str:
    first, _, bits = arguments.partition(";")
    controller.signals.write_inputs(signal_number(first), hexadecimal(bits))
    return ""


def _registers(values: dict[int, int], arguments: str) -> str:
    first = register_number(arguments)
    return ";".join(str(values.get(first + n, 0)) for n in range(WORD))


def _write_output_register(controller: Controller, arguments: str) -> str:
    register, _, value = arguments.partition(";")
    controller.signals.output_registers[register_number(register)] = hexadecimal(value)
    return ""


def _write_input_register(controller: Controller, arguments: str) -> str:
    register, _, value = arguments.partition(";")
    controller.signals.write_input_register(register_number(register), hexadecimal(value))
    return ""


def _pseudo(controller: Controller, *, on: bool) -> str:
    controller.signals.pseudo = on
    return ""


def _hands(controller: Controller) -> str:
    """One hand is fitted, single, on the first hand signal."""
    state = _OPEN if 1 in controller.signals.open_hands else _CLOSED
    return ";".join([f"{_FIRST_HAND_SIGNAL};{state};0", *["-1;-1;-1"] * 7])


def _stop_sources(controller: Controller) -> str:
    return f"{2 * controller.stop_latched:X};{int(controller.emergency_stop):X}"


def _origin(controller: Controller) -> str:
    axes = {4: "0F", 6: "3F", 8: "FF"}[controller.config.axis_pattern]
    return f"N{axes}{axes}"


COMMANDS = {
    "IOSIGNAL": Command(say(_both), arguments=True),
    "IN": Command(say(lambda c, a: f"{word(c.signals.inputs, signal_number(a)):04X}"), arguments=True),
    "IN=": Command(say(_write_inputs), arguments=True),
    "INDMY": Command(show(lambda c: _pseudo(c, on=True))),
    "INSET": Command(show(lambda c: _pseudo(c, on=False))),
    "OUT": Command(say(lambda c, a: f"{word(c.signals.outputs, signal_number(a)):04X}"), arguments=True),
    "OUT=": Command(say(_write_outputs), arguments=True),
    "DIN": Command(say(lambda c, a: _registers(c.signals.input_registers, a)), arguments=True),
    "DIN=": Command(say(_write_input_register), arguments=True),
    "DOUT": Command(say(lambda c, a: _registers(c.signals.output_registers, a)), arguments=True),
    "DOUT=": Command(say(_write_output_register), arguments=True),
    "HNDSTS": Command(show(_hands)),
    "STPSIG": Command(show(_stop_sources)),
    "USERAREASTS": Command(show(lambda _: "00")),
    "CALIB": Command(show(_origin)),
}
