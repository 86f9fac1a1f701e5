"""Input and output signals (sheet, section 1.12): single bits, read and written in words of 16."""

import re

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal

WORD = 16
LAST_SIGNAL = 255
"""Last general signal of this controller; a word at its end reads 0 beyond it."""

FIRST_REGISTER, LAST_REGISTER = 6000, 6255
"""CC-Link registers; the sheet gives the first one."""


class Signals:
    """Signals of one controller. Nothing is wired to the inputs: they read 0 unless pseudo-inputs are on."""

    def __init__(self) -> None:
        self.outputs: set[int] = set()
        self.pseudo = False
        self._pseudo_inputs: set[int] = set()
        self.output_registers: dict[int, int] = {}
        self._input_registers: dict[int, int] = {}
        self.open_hands: set[int] = set()

    @property
    def inputs(self) -> set[int]:
        """Numbers of those that are on; without pseudo input none is."""
        return self._pseudo_inputs if self.pseudo else set()

    @property
    def input_registers(self) -> dict[int, int]:
        """CC-Link registers that are not 0."""
        return self._input_registers if self.pseudo else {}

    def write_outputs(self, first: int, bits: int) -> None:
        """Switch the 16 outputs from the first one on."""
        _write(self.outputs, first, bits)

    def write_inputs(self, first: int, bits: int) -> None:
        """Set 16 pseudo-inputs; they show while pseudo-inputs are on."""
        _write(self._pseudo_inputs, first, bits)

    def write_input_register(self, register: int, value: int) -> None:
        """Set a pseudo-input register."""
        self._input_registers[register] = value


def word(on: set[int], first: int) -> int:
    """Return 16 signals, bit 0 the first one."""
    return sum(1 << n for n in range(WORD) if first + n in on)


def _write(on: set[int], first: int, bits: int) -> None:
    for n in range(WORD):
        signal = first + n
        if bits >> n & 1 and signal <= LAST_SIGNAL:
            on.add(signal)
        else:
            on.discard(signal)


def signal_number(text: str) -> int:
    """Return a signal's number.

    Raises:
        Refusal: there is no such signal.
    """
    return _number(text, 0, LAST_SIGNAL)


def register_number(text: str) -> int:
    """Return a CC-Link register's number.

    Raises:
        Refusal: there is no such register.
    """
    return _number(text, FIRST_REGISTER, LAST_REGISTER)


def hexadecimal(text: str) -> int:
    """Return a word of one to four hex digits.

    Raises:
        Refusal: the text is none.
    """
    if re.fullmatch(r"[0-9A-Fa-f]{1,4}", text) is None:
        raise Refusal(alarms.SYNTAX)
    return int(text, 16)


def _number(text: str, first: int, last: int) -> int:
    if re.fullmatch(r"[0-9]{1,5}", text) is None or not first <= int(text) <= last:
        raise Refusal(alarms.BAD_SIGNAL)
    return int(text)
