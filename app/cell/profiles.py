"""The profiles that installed drivers bring along."""

from catseye.drivers.roles.registry import working_drivers


def profiles_by_driver() -> dict[str, tuple[str, str]]:
    """Return the driver's name and the text of each profile, by the profile's name."""
    return {
        profile: (driver, text)
        for driver, loaded in working_drivers().items()
        for profile, text in loaded.profiles().items()
    }
