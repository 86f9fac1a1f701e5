"""One connection to the proxy: variables read and written; refusals become errors."""

from collections.abc import Callable, Mapping, Sequence
from itertools import chain
from typing import Final

from catseye.drivers.kuka import codec
from catseye.drivers.kuka.codec import Kind, Reply, ReplyDecoder
from catseye.drivers.kuka.names import SERIAL
from catseye.drivers.kuka.settings import KukaSettings
from catseye.drivers.kuka.values import string_of
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.errors import ProtocolError, RefusedError, WrongDeviceError

_PING: Final = "PING"
_PONG: Final = "PONG"
_TYPE: Final = "@PROXY_TYPE"
_C3: Final = "C3 BRIDGE"
_LARGEST_TAG: Final = 0xEFFF
"""Tags above are those of requests that are encoded beforehand."""


class Proxy:
    """A connection to KUKAVARPROXY or C3 Bridge.

    Attributes:
        link: that carries requests and replies.
        kind: what the proxy calls itself; empty for a KUKAVARPROXY of old, which does not say.
        serial: that the controller behind it has to have each time that the link is opened; empty: any.
    """

    def __init__(self, transport: Transport, settings: KukaSettings, *, name: str) -> None:
        self._settings = settings
        self._tag = 0
        self.kind = self.serial = ""
        self.link = RequestLink(
            transport, name=name, greet=self._greet, identify=self._ping, harmless=b"", stays_writable=True
        )

    @property
    def where(self) -> str:
        """Device and endpoint, for texts."""
        return self.link.where

    async def read(self, name: str) -> str:
        """Return the text of a variable.

        Raises:
            RefusedError: the controller has no such variable, or the proxy does not read it.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        return self._value(await self._ask(self._reading, (name,)), name)

    async def read_known(self, names: Sequence[str]) -> dict[str, str | None]:
        """Return the texts of variables; None for each that the controller refuses to read.

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        if not self.kind:
            return {name: await self._read_or_none(name) for name in names}
        items = (await self._ask(Kind.READ_MANY, names)).items
        if len(items) != len(names):
            raise ProtocolError(f"{self.where}: {len(names)} variables were asked for, {len(items)} came")
        pairs = zip(names, items, strict=True)
        return {name: item.text if item.error == codec.SUCCESS else None for name, item in pairs}

    async def read_all(self, names: Sequence[str]) -> tuple[str, ...]:
        """Return the texts of variables, all of which the controller has.

        Raises:
            RefusedError: it refuses to read one.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        found = await self.read_known(names)
        missing = [name for name, text in found.items() if text is None]
        if missing:
            raise RefusedError(f"{self.where}: {', '.join(missing)} cannot be read", 0)
        return tuple(text for text in found.values() if text is not None)

    async def write(
        self,
        values: Mapping[str, str],
        *,
        repeat: Repeat = Repeat.HARMLESS,
        permit: Callable[[], None] | None = None,
    ) -> None:
        """Write variables, one after the other.

        Args:
            values: texts by name.
            repeat: what may be done when a reply is lost.
            permit: asked right before each is written; what it raises keeps it from being written.

        Raises:
            RefusedError: one is refused; those after it are not written.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        for name, text in values.items():
            reply = await self._ask(self._writing, (name, text), repeat=repeat, permit=permit)
            self._value(reply, f"{name} = {text}")

    @property
    def _reading(self) -> Kind:
        return Kind.READ if self._settings.encoding == "ascii" else Kind.READ_WIDE

    @property
    def _writing(self) -> Kind:
        return Kind.WRITE if self._settings.encoding == "ascii" else Kind.WRITE_WIDE

    async def _read_or_none(self, name: str) -> str | None:
        try:
            return await self.read(name)
        except RefusedError:
            return None

    async def _ask(
        self,
        kind: Kind,
        texts: Sequence[str],
        *,
        repeat: Repeat = Repeat.HARMLESS,
        permit: Callable[[], None] | None = None,
    ) -> Reply:
        tag = self._next_tag()
        return await self.link.request(
            codec.encode_request(tag, kind, texts),
            lambda: ReplyDecoder(tag, kind),
            self._settings.answer_timeout_s,
            repeat=repeat,
            permit=permit,
        )

    def _next_tag(self) -> int:
        self._tag = self._tag % _LARGEST_TAG + 1
        return self._tag

    def _value(self, reply: Reply, what: str) -> str:
        """Return a value; a KUKAVARPROXY of old answers an unknown variable with success and no text."""
        if reply.error != codec.SUCCESS:
            why = codec.ERRORS.get(reply.error, f"error {reply.error}")
            raise RefusedError(f"{self.where}: {what}: {why}", reply.error)
        if not (text := reply.items[0].text):
            raise RefusedError(
                f"{self.where}: {what}: no value: the controller has no such variable", codec.SUCCESS
            )
        return text

    async def _exchange(self, name: str) -> Reply:
        tag = self._next_tag()
        request = codec.encode_request(tag, Kind.READ, (name,))
        decoder = ReplyDecoder(tag, Kind.READ)
        return await self.link.exchange(request, decoder, self._settings.answer_timeout_s)

    async def _ping(self) -> None:
        """Ask what only a proxy answers; the tag tells its reply from a late one."""
        reply = await self._exchange(_PING)
        if reply.error != codec.SUCCESS or reply.items[0].text != _PONG:
            raise WrongDeviceError(
                f"{self.where}: {_PING} is not answered with {_PONG}: this is not KUKAVARPROXY"
            )

    async def _greet(self) -> None:
        try:
            await self._ping()
        except ProtocolError as exc:
            raise ProtocolError(
                f"{exc}: check that the endpoint is that of KUKAVARPROXY or C3 Bridge"
            ) from None
        reply = await self._exchange(_TYPE)
        named = reply.items[0].text if reply.error == codec.SUCCESS else ""
        self.kind = named if named.upper().startswith(_C3) else ""
        if self.serial:
            await self._check_serial()

    async def _check_serial(self) -> None:
        reply = await self._exchange(SERIAL)
        serial = string_of(reply.items[0].text)
        if reply.error == codec.SUCCESS and serial != self.serial:
            raise WrongDeviceError(
                f"{self.where}: after the link was opened again the robot with the serial number {serial} answers "
                f"instead of {self.serial}: check the network"
            )


def stop_bytes(variables: Mapping[str, str]) -> bytes:
    """Return requests that write variables, encoded beforehand for what cannot wait.

    Args:
        variables: texts by name, the most important one first.
    """
    numbered = enumerate(variables.items(), _LARGEST_TAG + 1)
    return bytes(chain.from_iterable(codec.encode_request(tag, Kind.WRITE, pair) for tag, pair in numbered))
