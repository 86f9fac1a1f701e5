"""A Leica laser tracker behind an emScon server: LT, LTD, AT901, AT401 and AT402."""

import asyncio
import contextlib
import math
from collections.abc import Awaitable, Callable
from typing import ClassVar, TypeVar

from catseye.drivers.leica import codec, setup
from catseye.drivers.leica.commands import (
    BUSY,
    INITIALISED,
    LASER_READY,
    NO_TARGET,
    OK,
    REFUSED,
    TRACKER_NOT_READY,
    TRACKER_READY,
    Command,
    laser_text,
    status_text,
)
from catseye.drivers.leica.examining import examine, identify
from catseye.drivers.leica.measurement import ResultDecoder, StationaryResult
from catseye.drivers.leica.settings import LeicaSettings
from catseye.drivers.leica.uncertainty import point_of
from catseye.drivers.links.driver import LinkDriver
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.link import Decoder, RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Examination, Identity
from catseye.drivers.roles.errors import (
    DeviceError,
    HiddenTargetError,
    LinkError,
    LinkTimeoutError,
    NotSentError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from catseye.drivers.roles.tracker import (
    Face,
    Place,
    Position,
    TargetPoint,
    Tracker,
    TrackerAbilities,
    place_text,
    require_near,
)

T = TypeVar("T")

MODEL = "Leica tracker"

_BUSY_PAUSE_S = 0.2
_KEPT_BACK = 5
"""So often an order may be kept back before that is an error."""

_ATTEMPTS = 2
"""A target that is lost while it is measured is searched for once more."""


class LeicaEmscon(LinkDriver, Tracker):
    """Tracker driver.

    Coordinates are those of the instrument: its station and transformation parameters are not applied.

    Args:
        transport: the connection, to TCP port 700.
    """

    Settings: ClassVar[type[LeicaSettings]] = LeicaSettings
    abilities: ClassVar[TrackerAbilities] = TrackerAbilities(points=True, finds=True, two_faces=True)
    summary: ClassVar[str] = "Leica LT, LTD, AT901, AT401, AT402 with emScon, TCP"

    def __init__(self, transport: Transport, clock: Clock, settings: LeicaSettings | None = None) -> None:
        self._settings = settings or LeicaSettings()
        self._clock = clock
        self._turn = asyncio.Lock()
        self._identity: Identity | None = None
        self._reflector: int | None = None
        self._measuring = False
        self._link = RequestLink(
            transport,
            name=MODEL,
            greet=self._greet,
            identify=self._recognise,
            quiet_s=self._settings.quiet_s,
            harmless=b"",
            without_news=codec.without_unasked,
        )

    async def connect(self) -> Identity:
        """Open the link, check who answers, set units and coordinates; the tracker does not move.

        Raises:
            WrongDeviceError: something else answers.
            RefusedError: the tracker refuses a setting.
            LinkError: unreachable or silent.
        """
        self._identity = self._reflector = None
        await self._link.open()
        return self._known()

    async def close(self) -> None:
        """Disconnect; may be called any number of times. The tracker keeps its target."""
        await self._link.close()

    async def locate(self) -> Position:
        """Return x and y of the target that the tracker is locked on; its frame has to be levelled.

        Raises:
            HiddenTargetError: it sees none, or it has just been initialised; see `point`.
            DeviceError: the instrument failed.
        """
        seen = await self.point("the target", self._settings.plane_dwell_s)
        return Position(seen.place_mm[0], seen.place_mm[1], max(seen.u_mm or (0.0, 0.0, 0.0)))

    async def point(
        self, target: str, dwell_s: float, near_mm: Place | None = None, face: Face = 1
    ) -> TargetPoint:
        """Measure a target that stands still; the tracker is initialised before if need be.

        Raises:
            HiddenTargetError: no target is seen there; without a place, also where the tracker looks at the
                retroreflector of its own home position.
            RefusedError: the tracker refuses, states no uncertainty or an impossible one, or another program has
                changed its units, frame, reflector or face, also meanwhile.
            LinkError: lost or silent.
        """
        async with self._turn:
            if await self._get_ready() and near_mm is None:
                raise self._hidden(target, "the tracker was initialised and looks at its home position")
            await self._turn_to(face)
            await self._require(Command.SET_STATIONARY, "ii", max(1, round(1e3 * dwell_s)), 1)
            result = await self._measured(target, dwell_s, near_mm)
            await self._check_setup()
            await self._require_face(face)
        self._check_place(target, result.place_mm, near_mm)
        return point_of(self._link.where, target, result, self._settings)

    async def examine(self) -> Examination:
        """Ask for the state of laser, distance meter and target, the face, the reflector and the air."""
        return await examine(self._ask, self._link.where, self._settings)

    def _known(self) -> Identity:
        if self._identity is None:
            raise LinkError(
                f"{self._link.where}: the link was closed while it was being opened: connect again"
            )
        return self._identity

    async def _get_ready(self) -> bool:
        """Check laser and units; initialise the tracker if it is not, and return whether that was done.

        Raises:
            RefusedError: the laser is not ready, or the units are others.
        """
        _, processor, laser = (await self._require(Command.SYSTEM_STATUS)).values("3i")
        if laser != LASER_READY:
            raise RefusedError(
                f"{self._link.where}: {laser_text(int(laser))}: switch it on and let it warm up before measuring",
                0,
            )
        new = processor != INITIALISED
        if new:
            await self._order(Command.INITIALIZE, timeout_s=self._settings.initialise_timeout_s)
        await self._check_setup()
        return new

    async def _check_setup(self) -> None:
        if self._reflector is None:
            raise LinkError(f"{self._link.where}: not connected: connect first")
        await setup.check(self._ask, self._link.where, self._reflector)

    async def _turn_to(self, face: Face) -> None:
        if await self._face() != face:
            await self._order(Command.CHANGE_FACE, timeout_s=self._settings.move_timeout_s)
            await self._require_face(face)

    async def _require_face(self, face: Face) -> None:
        if (found := await self._face()) != face:
            raise RefusedError(
                f"{self._link.where}: the tracker is in face {found} and not in face {face}: if another program uses "
                "it, end that",
                0,
            )

    async def _face(self) -> int:
        return int((await self._require(Command.FACE)).values("i")[0])

    async def _measured(self, target: str, dwell_s: float, near_mm: Place | None) -> StationaryResult:
        """Point at a target and measure it; search once more when it is lost meanwhile."""
        for _ in range(_ATTEMPTS):
            await self._aim(target, near_mm)
            result = await self._measure(target, dwell_s)
            if result.status == OK:
                return result
            failure = await self._failure(target, Command.START_MEASUREMENT, result.status)
            if not isinstance(failure, HiddenTargetError):
                break
        raise failure

    async def _aim(self, target: str, near_mm: Place | None) -> None:
        """Lock on the target nearest to a place; without one keep that in the beam, or search around the beam."""
        timeout_s = self._settings.move_timeout_s + self._settings.search_timeout_s
        if near_mm is not None:
            await self._seek(target, Command.GO_POSITION, "3di", *near_mm, 1, timeout_s=timeout_s)
        elif await self._tracker_state() != TRACKER_READY:
            distance_mm = self._settings.find_distance_mm
            await self._seek(target, Command.FIND_REFLECTOR, "d", distance_mm, timeout_s=timeout_s)
        if await self._tracker_state() != TRACKER_READY:
            raise self._hidden(target, "the tracker is not locked on a target")

    async def _seek(
        self, target: str, command: Command, layout: str, *values: float, timeout_s: float
    ) -> None:
        reply = await self._carried_out(command, layout, *values, timeout_s=timeout_s)
        if reply.status != OK:
            raise await self._failure(target, command, reply.status)

    async def _measure(self, target: str, dwell_s: float) -> StationaryResult:
        """Measure once. A measurement without an end is stopped before anything else is asked, by `_recognise`."""
        timeout_s = self._settings.measure_timeout_s + dwell_s
        try:
            return await self._unless_busy(lambda: self._begun_and_ended(timeout_s))
        except LinkTimeoutError:
            if await self._tracker_state() == TRACKER_NOT_READY:
                raise self._hidden(target, "the beam was broken while it was measured") from None
            raise

    async def _begun_and_ended(self, timeout_s: float) -> StationaryResult:
        request = codec.encode(Command.START_MEASUREMENT)
        result = await self._sent_once(request, ResultDecoder, timeout_s, begun=self._begin_measuring)
        self._measuring = False
        return result

    def _begin_measuring(self) -> None:
        self._measuring = True

    async def _failure(self, target: str, command: Command, status: int) -> DeviceError:
        """Return why something failed: a tracker that is not ready for no other known reason sees no target."""
        unseen = status in NO_TARGET
        if unseen or (status not in REFUSED and await self._tracker_state() == TRACKER_NOT_READY):
            return self._hidden(target, status_text(status))
        return setup.refused(self._link.where, command, status)

    def _hidden(self, target: str, why: str) -> HiddenTargetError:
        return HiddenTargetError(
            f"{self._link.where}: {target} is not seen ({why}): turn it towards the tracker, lead the beam to "
            "it, and look for what stands in between"
        )

    def _check_place(self, target: str, place_mm: Place, near_mm: Place | None) -> None:
        """Refuse a target outside of the search radius; without an expected place, the tracker's own."""
        if near_mm is not None:
            require_near(self._link.where, target, place_mm, near_mm, self._settings.search_radius_mm)
        elif math.hypot(*place_mm) < self._settings.home_radius_mm:
            raise self._hidden(
                target, f"a retroreflector at {place_text(place_mm)} mm is seen: the home position"
            )

    async def _tracker_state(self) -> int:
        return int((await self._require(Command.TRACKER_STATUS)).values("i")[0])

    async def _order(self, command: Command, layout: str = "", *values: float, timeout_s: float) -> None:
        """Have something done that is never sent twice.

        Raises:
            RefusedError: it is not done.
        """
        reply = await self._carried_out(command, layout, *values, timeout_s=timeout_s)
        if reply.status != OK:
            raise setup.refused(self._link.where, command, reply.status)

    async def _carried_out(
        self, command: Command, layout: str = "", *values: float, timeout_s: float
    ) -> codec.Reply:
        """Return the reply to an order."""
        data = codec.encode(command, layout, *values)
        return await self._unless_busy(
            lambda: self._sent_once(data, lambda: codec.ReplyDecoder(command), timeout_s)
        )

    async def _unless_busy(self, ask: Callable[[], Awaitable[T]]) -> T:
        """Return the answer of a tracker that is not busy: what it has put off is asked again, for a while."""
        until_s = self._clock.monotonic_s() + self._settings.busy_timeout_s
        while True:
            answer = await ask()
            busy = isinstance(answer, codec.Reply | StationaryResult) and answer.status == BUSY
            if not busy or self._clock.monotonic_s() >= until_s:
                return answer
            await self._clock.sleep(_BUSY_PAUSE_S)

    async def _sent_once(
        self,
        data: bytes,
        decoder: Callable[[], Decoder[T]],
        timeout_s: float,
        *,
        begun: Callable[[], None] | None = None,
    ) -> T:
        """Send something at most once; what was kept back, since packets came that nobody asked for, was not sent."""
        for _ in range(_KEPT_BACK - 1):
            with contextlib.suppress(NotSentError):
                return await self._link.request(data, decoder, timeout_s, begun=begun)
        return await self._link.request(data, decoder, timeout_s, begun=begun)

    async def _require(self, command: Command, layout: str = "", *values: float) -> codec.Reply:
        return await setup.require(self._ask, self._link.where, command, layout, *values)

    async def _ask(self, data: bytes, decoder: Callable[[], Decoder[T]]) -> T:
        """Ask a question, or set what may be set any number of times."""
        timeout_s = self._settings.timeout_s
        return await self._unless_busy(
            lambda: self._link.request(data, decoder, timeout_s, repeat=Repeat.HARMLESS)
        )

    async def _exchange(self, data: bytes, decoder: Callable[[], Decoder[T]]) -> T:
        """Ask while the link is held; what an earlier connection had switched on may still come unasked."""
        await self._link.discard(0.0)
        return await self._link.exchange(data, decoder(), self._settings.timeout_s)

    async def _greet(self) -> None:
        """Ask who is there, stop what an interrupted measurement left behind, set up."""
        try:
            await setup.reply_to(self._exchange, Command.SYSTEM_STATUS)
        except (ProtocolError, LinkTimeoutError) as exc:
            raise self._stranger(exc) from None
        await self._stop_measuring()
        found = await identify(self._exchange)
        if self._identity is not None and self._identity != found:
            raise WrongDeviceError(
                f"{self._link.where}: after the link was opened again {found.model} {found.serial} answers "
                f"instead of {self._identity.model} {self._identity.serial}: check the network"
            )
        self._reflector = await setup.set_up(
            self._exchange, self._link.where, self._settings, self._reflector
        )
        self._identity = found

    async def _recognise(self) -> None:
        """Check on the open link that the next reply belongs to the next command; no result is owed then either."""
        await self._stop_measuring()
        await setup.reply_to(self._exchange, Command.SYSTEM_STATUS)

    async def _stop_measuring(self) -> None:
        if self._measuring:
            await setup.reply_to(self._exchange, Command.STOP_MEASUREMENT)
            self._measuring = False

    def _stranger(self, cause: LinkError | ProtocolError) -> Exception:
        if self._identity is not None or not self._link.last_bytes:
            return cause
        return WrongDeviceError(
            f"{self._link.where}: what answers here is not an emScon server: check host and port 700; {cause}"
        )
