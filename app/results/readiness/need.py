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
