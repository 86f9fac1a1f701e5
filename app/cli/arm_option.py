"""The arm that a command is about: a shipped description, or a file."""

from typing import TYPE_CHECKING

from catseye.app.errors import UsageError

if TYPE_CHECKING:
    from catseye.app.cell.arm import ArmDescription


def described(arm: str) -> "ArmDescription":
    """Return the description of --arm.

    Raises:
        UsageError: there is no arm of that name.
        ConfigError: the file cannot be read or is no description.
    """
    from catseye.app.cell.arm import arm_description

    try:
        return arm_description(arm)
    except ValueError as error:
        raise UsageError(
            f"--arm {arm}: {error}; or give the path of a description, ending with .toml"
        ) from error
