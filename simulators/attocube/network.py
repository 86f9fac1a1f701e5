"""The IDS's service network: a configuration that is set, verified, and then applied or discarded.

Names and parameters come from the maker's API (sheet `interferometers`, section 4). Assumed: what a fresh instrument
is set to; that `apply` refuses what `verify` refuses; that all calls about a radio are refused without one. What is
applied is answered from then on; the emulator itself stays at the endpoint where it listens.
"""

from functools import partial
from ipaddress import AddressValueError, IPv4Address, IPv4Network, NetmaskValueError

from catseye.simulators.attocube.errors import NOT_FITTED, WRONG_ADDRESS, IdsError, checked
from catseye.simulators.attocube.results import Method
from catseye.simulators.attocube.staged import Staged

_TEXTS = ("IpAddress", "SubnetMask", "DefaultGateway", "ProxyServer")
_FLAGS = ("EnableDhcpServer", "EnableDhcpClient")
_RESOLVERS = ("DnsResolver0", "DnsResolver1")
_RADIO_TEXTS = ("WifiSSID", "WifiPassphrase")


class Network:
    """The service.

    Args:
        address: of a fresh instrument.
        radio: it has a radio.
        shows_pending: see `Staged`.
    """

    def __init__(self, address: str, *, radio: bool, shows_pending: bool) -> None:
        self._radio = radio
        first: dict[str, str | int | bool] = dict.fromkeys(
            (*_TEXTS, *_RESOLVERS, *_RADIO_TEXTS, "WifiMode"), ""
        )
        first |= {"IpAddress": address, "SubnetMask": "255.255.255.0", "WifiMode": 0}
        self._settings = Staged(first | dict.fromkeys(_FLAGS, False), shows_pending=shows_pending)

    def methods(self) -> dict[str, Method]:
        """Return what it can do, by name."""
        found: dict[str, Method] = {
            "getRealIpAddress": lambda: [0, self._settings.acting["IpAddress"]],
            "getDnsResolver": lambda priority: self._settings.get(_resolver(priority)),
            "setDnsResolver": lambda priority, text: self._settings.set(_resolver(priority), _text(text)),
            "apply": self._apply,
            "verify": self._verify,
            "discard": self._settings.discard,
            **self._of_the_radio(),
        }
        for name in (*_TEXTS, *_FLAGS):
            found[f"get{name}"] = partial(self._settings.get, name)
        for name in _TEXTS:
            found[f"set{name}"] = partial(self._set_text, name)
        for name in _FLAGS:
            found[f"set{name}"] = partial(self._set_flag, name)
        return {f"com.attocube.system.network.{name}": method for name, method in found.items()}

    def _of_the_radio(self) -> dict[str, Method]:
        found: dict[str, Method] = {
            "getWifiPresent": lambda: [0, self._radio],
            "getWifiMode": lambda: self._fitted().get("WifiMode"),
            "setWifiMode": lambda mode: self._fitted().set("WifiMode", checked(mode, 0, 1)),
            "configureWifi": self._configure_radio,
        }
        for name in _RADIO_TEXTS:
            found[f"get{name}"] = lambda name=name: self._fitted().get(name)
            found[f"set{name}"] = lambda text, name=name: self._fitted().set(name, _text(text))
        return found

    def _fitted(self) -> Staged:
        if not self._radio:
            raise IdsError(NOT_FITTED)
        return self._settings

    def _configure_radio(self, mode: int, name: str, passphrase: str) -> list[object]:
        radio = self._fitted()
        radio.put("WifiMode", checked(mode, 0, 1))
        radio.put("WifiSSID", _text(name))
        return radio.put("WifiPassphrase", _text(passphrase))

    def _set_text(self, name: str, text: str) -> list[object]:
        return self._settings.set(name, _text(text))

    def _set_flag(self, name: str, on: bool) -> list[object]:
        return self._settings.set(name, bool(on))

    def _verify(self) -> list[object]:
        wanted = self._settings.wanted
        try:
            IPv4Address(wanted["IpAddress"])
            IPv4Network(f"0.0.0.0/{wanted['SubnetMask']}")
            for name in ("DefaultGateway", *_RESOLVERS):
                if wanted[name]:
                    IPv4Address(wanted[name])
        except (AddressValueError, NetmaskValueError):
            raise IdsError(WRONG_ADDRESS) from None
        return [0]

    def _apply(self) -> list[object]:
        self._verify()
        return self._settings.apply()


def _resolver(priority: int) -> str:
    return _RESOLVERS[checked(priority, 0, 1)]


def _text(text: object) -> str:
    if not isinstance(text, str):
        raise TypeError(text)
    return text
