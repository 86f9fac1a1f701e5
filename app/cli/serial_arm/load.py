"""Results that say nothing of the load that bends the arm."""

from typing import TYPE_CHECKING

from catseye.app.cli.output import warn

if TYPE_CHECKING:
    from catseye.app.results.serial_arm.result import SerialArmResult


def warn_of_load(result: "SerialArmResult") -> None:
    """Warn of a result whose torques may lack its tool."""
    from catseye.app.results.serial_arm.missing_load import read_without_load

    if text := read_without_load(result):
        warn(text)
