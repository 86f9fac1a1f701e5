"""One thing that a procedure needs, and whether the devices are there. Light: nothing is imported for it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

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


def links_need(devices: Sequence[Mapping[str, Any]] | None) -> Need:
    """Return whether the devices are connected.

    Args:
        devices: as the engine tells them about the bench; None before it has told any.
    """
    if devices is None:
        return Need("devices", "advised", "nothing is known of them yet")
    lost = [device for device in devices if device.get("link") in {"lost", "raw"}]
    if lost:
        told = "; ".join(f"{device['name']}: {device.get('error') or device['link']}" for device in lost)
        return Need("devices", "missing", told)
    waiting = [str(device["name"]) for device in devices if device.get("link") == "connecting"]
    if waiting:
        return Need("devices", "advised", f"connecting: {', '.join(waiting)}")
    return Need("devices", "met", ", ".join(str(device["name"]) for device in devices))
