"""Where a cell says that its bench is emulated: it has hands that do what operators are asked for."""

from typing import cast
from urllib.parse import urlsplit

from catseye.app.cell.model import Cell
from catseye.app.errors import ConfigError
from catseye.drivers.roles.registry import load_driver
from catseye.drivers.roles.tracker import Tracker


def hands_endpoint(cell: Cell) -> str | None:
    """Return where the hands of an emulated operator reach the bench; None where the cell does not say.

    Raises:
        ConfigError: the tracker's driver is not installed.
    """
    tracker = cell.tracker
    if tracker is None:
        return None
    return tracker.endpoint if tracker_driver(tracker.driver).has_hands else tracker.control


def robot_is_emulated(cell: Cell) -> bool:
    """Return whether the cell says that its robot is emulated: on the machine that has the hands of the bench.

    An address of this machine says nothing of that: a tunnel to a real controller begins there, too.

    Raises:
        ConfigError: the tracker's driver is not installed.
    """
    hands = hands_endpoint(cell)
    return hands is not None and urlsplit(hands).hostname == urlsplit(cell.robot.endpoint).hostname


def tracker_driver(name: str) -> type[Tracker]:
    """Return the driver of a tracker.

    Raises:
        ConfigError: it is not installed.
    """
    try:
        return cast("type[Tracker]", load_driver(name, "tracker"))
    except LookupError as error:
        raise ConfigError(f"[tracker] driver: {error.args[0]}") from error
