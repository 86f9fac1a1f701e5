"""Files that a program opens (sheet, sections 2 and 4.1): real-time control by `Open "ENET:…"` and `Mxt`.

    Open "ENET:192.168.0.10" As #1
    Mxt 1,<0 XYZ | 1 joint | 2 pulse>[,<filter ms>]
    Close #1

While `Mxt` is carried out, the controller's real-time port obeys its PC; END (command 255) leads to the next line, a
time-out is alarm H7820. Assumed are: an address that is none, a file number in use or not open and a port that this
bench does not have or another program leads are L6130; after STOP the program goes on with `Mxt` again; END and a new
start close all files. Datagrams of any address are taken, as by the program that is emulated without its code. Other
files (`COM2:`) are not interpreted.
"""

import ipaddress
import re
from collections.abc import Callable
from typing import Protocol

from catseye.simulators.melfa import alarms
from catseye.simulators.melfa.alarms import Refusal

WORDS = frozenset({"OPEN", "CLOSE", "MXT"})

_OPEN = re.compile(r'OPEN\s*"ENET:([^"]*)"\s*AS\s*#?\s*([1-8])')
_CLOSE = re.compile(r"CLOSE(?:\s*#?\s*([1-8]))?")
_MXT = re.compile(r"MXT\s*#?\s*([1-8])\s*,\s*([0-2])\s*(?:,\s*(\d{1,5}))?")

Begin = Callable[[Callable[[], None]], None]
"""Begins something; calls what it is given at its end."""


class RealTimePort(Protocol):
    """The controller's port for real-time control.

    Attributes:
        opened: the selected program has it open: nothing else is started by a client's first word.
    """

    opened: bool

    def lend(self, mode: int, filter_s: float, ended: Callable[[], None]) -> None:
        """Obey set points until END.

        Args:
            mode: 0 XYZ, 1 joint, 2 pulse.
            filter_s: length of the moving average over the set points.
            ended: called after END, when the arm stands at the last set point.

        Raises:
            Refusal: a program obeys set points already.
        """
        ...

    def take_back(self) -> None:
        """Obey no longer; nothing is called."""
        ...


class OpenFiles:
    """What the selected program has open.

    Args:
        port: returns the real-time port, None on a bench without one.
    """

    def __init__(self, port: Callable[[], RealTimePort | None]) -> None:
        self._port = port
        self._numbers: set[str] = set()

    def carry_out(self, text: str) -> Begin | None:
        """Carry out a statement; return what has to be waited for.

        Raises:
            Refusal: it is not understood or cannot be carried out.
        """
        if (found := _OPEN.fullmatch(text)) is not None:
            self._open(*found.groups())
            return None
        if (found := _CLOSE.fullmatch(text)) is not None:
            self._close({found[1]} if found[1] else set(self._numbers))
            return None
        if (found := _MXT.fullmatch(text)) is not None:
            return self._real_time(*found.groups())
        raise Refusal(alarms.SYNTAX)

    def close_all(self) -> None:
        """Close what is open."""
        self._close(set(self._numbers))

    def halt(self) -> None:
        """Let go of the real-time port: the program stands."""
        if (port := self._port()) is not None:
            port.take_back()

    def _open(self, address: str, number: str) -> None:
        try:
            ipaddress.IPv4Address(address.strip())
        except ValueError:
            raise Refusal(alarms.NETWORK) from None
        port = self._port()
        if number in self._numbers or port is None:
            raise Refusal(alarms.NETWORK)
        self._numbers.add(number)
        port.opened = True

    def _close(self, numbers: set[str]) -> None:
        self._numbers -= numbers
        if (port := self._port()) is not None:
            port.opened = bool(self._numbers)

    def _real_time(self, number: str, mode: str, filter_ms: str | None) -> Begin:
        port = self._port()
        if number not in self._numbers or port is None:
            raise Refusal(alarms.NETWORK)
        return lambda ended: port.lend(int(mode), int(filter_ms or 0) / 1e3, ended)
