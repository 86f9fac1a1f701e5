"""One thing that a procedure needs, and whether the devices are there. Light: nothing is imported for it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from catseye.app.protocol.bench import DeviceStatus

Met = Literal["met", "advised", "missing"]
"""Advised: it can begin without, and the result suffers. Missing: it is refused."""


@dataclass(frozen=True)
class Need:
    """One thing that a procedure needs.

    Attributes:
        what: it is, in one or two words.
        met: whether it is there.
        text: what is there, or what to do.
    """

    what: str
    met: Met
    text: str


def links_need(devices: "Sequence[DeviceStatus] | None") -> Need:
    """Return whether the devices are connected.

    Args:
        devices: of the bench; None before anything is known of it.
    """
    if devices is None:
        return Need("devices", "advised", "nothing is known of them yet")
    lost = [device for device in devices if device.link in {"lost", "raw"}]
    if lost:
        why = "; ".join(f"{device.name}: {device.error or device.link}" for device in lost)
        return Need("devices", "missing", why)
    waiting = [device.name for device in devices if device.link == "connecting"]
    if waiting:
        return Need("devices", "advised", f"connecting: {', '.join(waiting)}")
    return Need("devices", "met", ", ".join(device.name for device in devices))


def alarm_need(number: int, text: str, *, resets: bool) -> Need:
    """Return whether the controller may move the arm: in an alarm it does not.

    Args:
        number: of its alarm, 0 for none.
        text: what it means and what to do.
        resets: a program can reset it; otherwise its text says who does.
    """
    if not number:
        return Need("controller", "met", "in no alarm")
    how = "; then reset it: ! on Bench (F2), or catseye reset-alarm" if resets else ""
    return Need("controller", "missing", f"in alarm {number}: {text}{how}")
