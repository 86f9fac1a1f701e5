"""The profiles that installed drivers bring along."""

from catseye.drivers.roles.registry import driver_names, load_driver


def profiles_by_driver() -> dict[str, tuple[str, str]]:
    """Return the driver's name and the text of each profile, by the profile's name."""
    return {
        profile: (driver, text)
        for driver in driver_names()
        for profile, text in load_driver(driver).profiles().items()
    }
