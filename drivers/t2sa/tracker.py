"""Any tracker or optical CMM that SpatialAnalyzer drives, through its text interface T2SA."""

import asyncio
from collections.abc import Callable
from typing import ClassVar, Final, Literal, TypeVar

from pydantic import Field

from catseye.drivers.links.driver import DeviceSettings, LinkDriver
from catseye.drivers.links.healing import Repeat
from catseye.drivers.links.link import RequestLink
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Examination, Identity
from catseye.drivers.roles.errors import (
    HiddenTargetError,
    LinkError,
    LinkTimeoutError,
    ProtocolError,
    RefusedError,
    WrongDeviceError,
)
from catseye.drivers.roles.rotations import as_fixed_axes_deg
from catseye.drivers.roles.tracker import (
    Face,
    Place,
    Position,
    TargetPoint,
    TargetPose,
    Tracker,
    TrackerAbilities,
    require_near,
)
from catseye.drivers.t2sa import codec

T = TypeVar("T")

MODEL = "SpatialAnalyzer T2SA"

_MM: Final = {"mm": 1.0, "m": 1000.0, "inch": 25.4}
_DEG: Final = {"deg": 1.0, "rad": 57.29577951308232}
_BUSY_PAUSE_S = 0.5
_WARMING_PAUSE_S = 1.0
_LIT, _DARK, _WARMING = "LON", "LOFF", "WARM"


class T2saSettings(DeviceSettings):
    """What a cell file may set. Times are real seconds, but for `warm_up_timeout_s`."""

    collection: str = Field(default="A", description="of SpatialAnalyzer in which points are measured.")
    group: str = Field(default="catseye", description="of points in SpatialAnalyzer.")
    point: str = Field(
        default="{target}", description="name of a point; {target} stands for the target's name."
    )
    plane_target: str = Field(default="P1", description="name of the target for places in the plane.")
    working_frame: str = Field(default="", description="that is set at the start; empty: it is left alone.")
    simulates: bool = Field(default=False, description="SpatialAnalyzer simulates its instrument.")
    has_laser: bool = Field(
        default=True, description="the instrument has a laser that has to be on; an optical CMM has none."
    )
    switches_laser_on: bool = Field(
        default=False, description="whether a laser that is off is switched on for the first point."
    )
    measures_before_pose: bool = Field(
        default=True, description="whether a group is measured before its pose is asked for."
    )
    length_unit: Literal["mm", "m", "inch"] = Field(
        default="mm", description="of reports of poses: that of the job in SpatialAnalyzer; points are in mm."
    )
    angle_unit: Literal["deg", "rad"] = Field(default="deg", description="of reports of poses.")
    turns: Literal["fixed-axes", "moving-axes"] = Field(
        default="fixed-axes",
        description="how Rx, Ry, Rz of a report turn: R = Rz·Ry·Rx, which is likely, or R = Rx·Ry·Rz; compare with a "
        "pose that you know.",
    )
    search_radius_mm: float = Field(
        default=25.0,
        gt=0,
        description="around the place where a target is expected: what is measured outside is another one; half the "
        "distance of two targets at most.",
    )
    u_mm: float | None = Field(default=None, gt=0, description="standard uncertainty of a coordinate.")
    u_deg: float | None = Field(
        default=None, gt=0, description="standard uncertainty of each rotation of a pose; state it with u_mm."
    )
    measure_timeout_s: float = Field(default=60.0, gt=0, description="for a measurement beyond its dwell.")
    warm_up_timeout_s: float = Field(
        default=900.0, gt=0, description="for a laser that is switched on, s of the clock."
    )
    busy_timeout_s: float = Field(default=60.0, gt=0, description="for a busy SpatialAnalyzer.")
    timeout_s: float = Field(default=5.0, gt=0, description="for an answer.")
    connect_timeout_s: float = Field(default=5.0, gt=0, description="for connecting.")
    quiet_s: float = Field(default=0.02, gt=0, description="silence after which a link counts as drained.")


class T2sa(LinkDriver, Tracker):
    """Tracker driver. Coordinates are those of SpatialAnalyzer's working frame.

    Args:
        transport: the connection, over TCP.
    """

    Settings: ClassVar[type[T2saSettings]] = T2saSettings
    abilities: ClassVar[TrackerAbilities] = TrackerAbilities(points=True, poses=True)
    summary: ClassVar[str] = "trackers and optical CMMs behind SpatialAnalyzer (T2SA), TCP"

    def __init__(self, transport: Transport, clock: Clock, settings: T2saSettings | None = None) -> None:
        self._settings = settings or T2saSettings()
        self._clock = clock
        self._turn = asyncio.Lock()
        self._hello = ""
        self._measuring = False
        self._link = RequestLink(transport, name=MODEL, greet=self._greet, quiet_s=self._settings.quiet_s)

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about this connection."""
        return (
            "how long a point is averaged is set by the measurement profile in SpatialAnalyzer, not by the dwell",
        )

    async def connect(self) -> Identity:
        """Open the link and check who answers.

        Raises:
            WrongDeviceError: something else answers.
            RefusedError: the working frame is unknown there.
            LinkError: unreachable or silent.
        """
        self._hello = ""
        await self._link.open()
        return Identity(MODEL, "", "", "EMULATOR" in self._hello.upper())

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._link.close()

    async def locate(self) -> Position:
        """Return x and y of the target `plane_target`; the working frame has to be level.

        Raises:
            HiddenTargetError: it is not seen.
            RefusedError: nobody has stated how uncertain a place is.
            DeviceError: the instrument failed.
        """
        if self._settings.u_mm is None:
            raise RefusedError(
                f"{self._link.where}: T2SA does not say how uncertain a place is: state u_mm in [tracker.settings]",
                0,
            )
        seen = await self.point(self._settings.plane_target, 0.0)
        return Position(seen.place_mm[0], seen.place_mm[1], self._settings.u_mm)

    async def point(
        self, target: str, dwell_s: float, near_mm: Place | None = None, face: Face = 1
    ) -> TargetPoint:
        """Measure a target that stands still; SpatialAnalyzer points at it by its name.

        Raises:
            HiddenTargetError: it is not seen, or another one is, far from where it is expected.
            RefusedError: there is no such point, the laser is not ready, or the second face is wanted.
            LinkError: lost or silent.
        """
        if face != 1:
            raise RefusedError(f"{self._link.where}: T2SA measures no single point in face {face}", 0)
        group, name = self._named(self._settings.group), self._named(self._point_name(target))
        collection = self._named(self._settings.collection)
        async with self._turn:
            await self._require_laser()
            reply = await self._measured(f"!MEAS_SINGLE_POINT:{collection};{group};{name}", target, dwell_s)
        found = self._parsed(codec.parse_point, reply.text)
        if found.name != name:
            self._link.distrust("another point was answered")
            raise ProtocolError(f"{self._link.where}: {found.name!r} was measured instead of {name!r}")
        if not found.good:
            raise self._hidden(target, "SpatialAnalyzer does not call the measurement good")
        if near_mm is not None:
            require_near(self._link.where, target, found.place_mm, near_mm, self._settings.search_radius_mm)
        u_mm = self._settings.u_mm
        return TargetPoint(found.place_mm, None if u_mm is None else (u_mm, u_mm, u_mm))

    async def pose(self, target: str, dwell_s: float) -> TargetPose:
        """Measure the group of a target's name and return its pose.

        Raises:
            HiddenTargetError: too little of it is seen.
            RefusedError: there is no such group, or the laser is not ready.
            LinkError: lost or silent.
        """
        group = self._named(target)
        async with self._turn:
            await self._require_laser()
            if self._settings.measures_before_pose:
                await self._measured(f"!CMDEXE:{group}", target, dwell_s)
            reply = await self._accepted(f"?POS {group}", target, repeat=Repeat.HARMLESS)
        place, turn = self._parsed(codec.parse_report, reply.text)
        x, y, z = (_MM[self._settings.length_unit] * value for value in place)
        rx, ry, rz = (_DEG[self._settings.angle_unit] * value for value in turn)
        fixed = self._settings.turns == "fixed-axes"
        u_mm, u_deg = self._settings.u_mm, self._settings.u_deg
        return TargetPose(
            (x, y, z),
            (rx, ry, rz) if fixed else as_fixed_axes_deg((rx, ry, rz)),
            u_mm=None if u_mm is None else (u_mm, u_mm, u_mm),
            u_deg=None if u_deg is None else (u_deg, u_deg, u_deg),
        )

    async def examine(self) -> Examination:
        """Ask for the state of SpatialAnalyzer and of the laser."""
        status = await self._ask("?STAT")
        facts, advice = [f"SpatialAnalyzer: {status.text or status.code}"], list[str]()
        if not status.ok and status.code != codec.BUSY:
            advice.append(
                f"SpatialAnalyzer is not ready (ERR-{status.code} {status.text}): start its instrument"
            )
        if self._settings.has_laser:
            state = (await self._ask("?LSTA")).text
            facts.append(f"laser: {state}")
            if state != _LIT:
                advice.append(f"the laser is not ready ({state}): switch it on and let it warm up")
        return Examination(tuple(facts), tuple(advice))

    async def _require_laser(self) -> None:
        """Check that the laser is on and warm, or switch it on where the settings say so.

        Raises:
            RefusedError: it is not.
        """
        if not self._settings.has_laser:
            return
        state = (await self._accepted("?LSTA", "the laser", repeat=Repeat.HARMLESS)).text
        if state == _DARK and self._settings.switches_laser_on:
            await self._accepted("!LST:1", "the laser")
            state = await self._warmed_up()
        if state != _LIT:
            raise RefusedError(
                f"{self._link.where}: the laser is not ready ({state}): switch it on in SpatialAnalyzer, or set "
                "switches_laser_on, and let it warm up",
                0,
            )

    async def _warmed_up(self) -> str:
        until_s = self._clock.monotonic_s() + self._settings.warm_up_timeout_s
        while True:
            state = (await self._accepted("?LSTA", "the laser", repeat=Repeat.HARMLESS)).text
            if not state.startswith(_WARMING) or self._clock.monotonic_s() >= until_s:
                return state
            await self._clock.sleep(_WARMING_PAUSE_S)

    async def _measured(self, command: str, target: str, dwell_s: float) -> codec.Reply:
        """Have something measured; one that is interrupted is halted before anything else is asked."""
        timeout_s = self._settings.measure_timeout_s + dwell_s
        return await self._accepted(command, target, timeout_s=timeout_s, begun=self._begin_measuring)

    def _begin_measuring(self) -> None:
        self._measuring = True

    async def _accepted(
        self,
        command: str,
        target: str,
        *,
        repeat: Repeat = Repeat.NEVER,
        timeout_s: float | None = None,
        begun: Callable[[], None] | None = None,
    ) -> codec.Reply:
        """Return the answer to a command; while SpatialAnalyzer is busy, which is no answer, it is given again.

        Raises:
            HiddenTargetError: the target could not be measured.
            RefusedError: another error is answered.
        """
        until_s = self._clock.monotonic_s() + self._settings.busy_timeout_s
        while True:
            reply = await self._ask(command, repeat=repeat, timeout_s=timeout_s, begun=begun)
            # Whatever was begun has ended.
            self._measuring = False
            if reply.ok:
                return reply
            if reply.code != codec.BUSY or self._clock.monotonic_s() >= until_s:
                break
            await self._clock.sleep(_BUSY_PAUSE_S)
        if reply.code in codec.HIDDEN:
            raise self._hidden(target, f"ERR-{reply.code} {reply.text}")
        raise RefusedError(
            f"{self._link.where}: {command} was refused: ERR-{reply.code} {reply.text}"
            + (": check its name in SpatialAnalyzer" if reply.code == codec.NO_SUCH_POINT else ""),
            reply.code,
        )

    async def _ask(
        self,
        command: str,
        *,
        repeat: Repeat = Repeat.HARMLESS,
        timeout_s: float | None = None,
        begun: Callable[[], None] | None = None,
    ) -> codec.Reply:
        data, wait_s = codec.encode(command), self._settings.timeout_s if timeout_s is None else timeout_s
        return await self._link.request(data, codec.ReplyDecoder, wait_s, repeat=repeat, begun=begun)

    def _parsed(self, parse: Callable[[str], T], text: str) -> T:
        try:
            return parse(text)
        except ProtocolError as exc:
            self._link.distrust("an answer made no sense")
            raise ProtocolError(f"{self._link.where}: {exc}") from None

    def _point_name(self, target: str) -> str:
        return self._settings.point.replace("{target}", target)

    def _named(self, name: str) -> str:
        if not codec.is_name(name):
            raise RefusedError(f"{self._link.where}: {name!r} cannot be a name in SpatialAnalyzer", 0)
        return name

    def _hidden(self, target: str, why: str) -> HiddenTargetError:
        return HiddenTargetError(
            f"{self._link.where}: {target} is not seen ({why}): turn it towards the instrument, and look for what "
            "stands in between"
        )

    async def _greet(self) -> None:
        """Halt what an earlier connection left unfinished, set simulation and frame, see who is there."""
        try:
            if self._measuring:
                await self._exchange("!HALT")
                self._measuring = False
            self._hello = (await self._set(f"!SET_SIM:{int(self._settings.simulates)}", "simulates")).text
            await self._exchange("?STAT")
        except (ProtocolError, LinkTimeoutError) as exc:
            raise self._stranger(exc) from None
        if self._settings.working_frame:
            frame = self._named(self._settings.working_frame)
            await self._set(f"!SET_WORKING_FRAME:{frame}", "working_frame")

    async def _set(self, command: str, setting: str) -> codec.Reply:
        """Have a setting take effect within the greeting; while SpatialAnalyzer is busy, it is given again.

        Raises:
            RefusedError: it does not take effect.
        """
        until_s = self._clock.monotonic_s() + self._settings.busy_timeout_s
        while (reply := await self._exchange(command)).code == codec.BUSY:
            if self._clock.monotonic_s() >= until_s:
                break
            await self._clock.sleep(_BUSY_PAUSE_S)
        if reply.ok:
            return reply
        busy = reply.code == codec.BUSY
        advice = "end what it does" if busy else f"correct {setting} in [tracker.settings]"
        raise RefusedError(
            f"{self._link.where}: {command} was refused: ERR-{reply.code} {reply.text}: {advice}", reply.code
        )

    async def _exchange(self, command: str) -> codec.Reply:
        return await self._link.exchange(
            codec.encode(command), codec.ReplyDecoder(), self._settings.timeout_s
        )

    def _stranger(self, cause: LinkError | ProtocolError) -> Exception:
        if self._hello or not self._link.last_bytes:
            return cause
        return WrongDeviceError(
            f"{self._link.where}: what answers here is not T2SA: check host and port, and that T2SA runs beside "
            f"SpatialAnalyzer; {cause}"
        )
