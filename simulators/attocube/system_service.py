"""The IDS's services about itself: com.attocube.system, system.about and system.update.

Names, parameters and results come from the maker's API (system_service.py, about.py, update.py); of recommendations
it says that they are 0. What real instruments are called is not public: names, numbers and licences say EMULATOR.
Assumed: a name acts at once; an image that is uploaded goes on where the one before ended. This device installs
nothing, and has no way to the internet.
"""

import base64
import binascii
from collections.abc import Callable
from datetime import datetime
from functools import partial
from typing import Literal

from catseye.simulators.attocube.errors import NO_IMAGE, NO_INTERNET, NO_PACKAGE, OUT_OF_RANGE, IdsError, text
from catseye.simulators.attocube.results import Method

_NAME = "catseye EMULATOR"
_PACKAGE = "catseye"
_MOST_BYTES = 64 << 20


class SystemService:
    """The services.

    Args:
        dialect: generation of the instrument.
        reboot: begins a reboot.
        soft_reset: sets everything but the network to its defaults.

    Attributes:
        resets: the next reboot sets everything to its defaults.
    """

    def __init__(
        self, dialect: Literal["ids", "sen"], reboot: Callable[[], None], soft_reset: Callable[[], None]
    ) -> None:
        self._dialect = dialect
        self._reboot = reboot
        self._soft_reset = soft_reset
        self._name = _NAME
        self._uploaded = {"software": 0, "license": 0}
        self.resets = False

    def methods(self) -> dict[str, Method]:
        """Return what they can do, by name."""
        found = self._system() | self._about() | self._update()
        found |= self._newer() if self._dialect == "sen" else {"apply": lambda: [0]}
        return {f"com.attocube.system.{name}": method for name, method in found.items()}

    def _system(self) -> dict[str, Method]:
        return {
            "errorNumberToString": lambda _language, number: [0, text(number)],
            "errorNumberToRecommendation": lambda _language, _number: [0, 0],
            "getFirmwareVersion": lambda: [0, "catseye 1.0"],
            "getDeviceName": lambda: [0, self._name],
            "setDeviceName": self._rename,
            "getFluxCode": lambda: [0, "EMULATOR"],
            "getHostname": lambda: [0, "emulator"],
            "getMacAddress": lambda: [0, "02:00:00:00:00:01"],
            "getSerialNumber": lambda: [0, "EMULATOR"],
            "factoryReset": self._reset,
            "rebootSystem": self._restart,
            "updateTimeFromInternet": partial(_refuse, NO_INTERNET),
        }

    def _newer(self) -> dict[str, Method]:
        return {
            "getHardwareInfo": lambda: [0, "EMULATOR"],
            "setTime": _set_time,
            "softReset": self._reset_softly,
        }

    def _about(self) -> dict[str, Method]:
        return {
            "about.getInstalledPackages": lambda: [0, _PACKAGE],
            "about.getPackageLicense": _license,
        }

    def _update(self) -> dict[str, Method]:
        return {
            "update.getSwUpdateProgress": lambda: [0, 0],
            "update.getLicenseUpdateProgress": lambda: [0, 0],
            "update.uploadSoftwareImageBase64": partial(self._upload, "software"),
            "update.uploadLicenseBase64": partial(self._upload, "license"),
            "update.softwareUpdateBase64": partial(_refuse, NO_IMAGE),
            "update.licenseUpdateBase64": partial(_refuse, NO_IMAGE),
        }

    def _rename(self, name: str) -> list[object]:
        if not isinstance(name, str):
            raise TypeError(name)
        self._name = name
        return [0]

    def _reset(self) -> list[object]:
        self.resets = True
        return [0]

    def _reset_softly(self) -> list[object]:
        self._soft_reset()
        return [0]

    def _restart(self) -> list[object]:
        self._reboot()
        return [0]

    def _upload(self, kind: str, offset: int, data: str) -> list[object]:
        try:
            size = len(base64.b64decode(data, validate=True))
        except binascii.Error:
            raise IdsError(OUT_OF_RANGE) from None
        if offset not in {0, self._uploaded[kind]} or offset + size > _MOST_BYTES:
            raise IdsError(OUT_OF_RANGE)
        self._uploaded[kind] = offset + size
        return [0]


def _refuse(number: int) -> list[object]:
    raise IdsError(number)


def _license(package: str) -> list[object]:
    if package != _PACKAGE:
        raise IdsError(NO_PACKAGE)
    return [0, "EMULATOR: see the licence of catseye"]


def _set_time(day: int, month: int, year: int, hour: int, minute: int, second: int) -> list[object]:
    try:
        datetime(year, month, day, hour, minute, second)  # noqa: DTZ001  # it is only looked at
    except ValueError:
        raise IdsError(OUT_OF_RANGE) from None
    return [0]
