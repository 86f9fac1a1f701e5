"""A MELFA SCARA that is led by set points: R-protocol for the controller, MXT datagrams for motion.

Session, servo, override, alarms and STOP go over the R-protocol. A way is sent as one set point in every cycle of
the controller, so the arm carries the aim of every cycle; its speed is bounded by settings and by the override, which
the controller itself does not apply to set points. A way begins with a look where the arm stands and ends with END,
so that nothing streams while the arm is at rest.

Each way shows how far every joint follows behind its set points. From the next way on the joints that follow sooner
get theirs later, so that all of them are at one place of the way at one time. Nothing of this outlives a connection.
"""

import asyncio
import contextlib
import logging
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, ClassVar, Self

from catseye.drivers.links.cancelling import uninterrupted
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.guarding import LinkGuard, guarded
from catseye.drivers.melfa.codec import parse_number
from catseye.drivers.melfa.led import LedArm, parted, require_way
from catseye.drivers.melfa.motion import COMMANDED, LOOK_WHY, off_target, require_unlocked
from catseye.drivers.melfa.mxt import codec
from catseye.drivers.melfa.mxt.codec import Command
from catseye.drivers.melfa.mxt.lag import LagLearner, WayTrace
from catseye.drivers.melfa.mxt.profile import Bounds, WayProfile, excess
from catseye.drivers.melfa.mxt.settings import MxtSettings
from catseye.drivers.melfa.mxt.stream import SetPointStream
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity, Sink
from catseye.drivers.roles.errors import (
    DeviceError,
    LinkError,
    LinkTimeoutError,
    NotArrivedError,
    NotReadyError,
    ProtocolError,
    RefusedError,
)
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import RobotAbilities

LONGEST_TIMEOUT_S = 0.5
"""A real arm that gets no set point any more ends the control by itself after so long at most."""

_log = logging.getLogger(__name__)

_REST_CYCLES = 5
_REST_DEG = 1e-3


class MelfaMxt(LedArm):
    """Robot driver."""

    Settings: ClassVar[type[MxtSettings]] = MxtSettings
    summary: ClassVar[str] = "MELFA with program CATSMXT: streams set points"
    protocols: ClassVar[Mapping[str, str] | None] = {"endpoint": "melfa-r3", "mxt_endpoint": "melfa-mxt"}
    abilities: ClassVar[RobotAbilities] = RobotAbilities(
        following="streamed",
        jogs=True,
        takes_guard=True,
        resets_alarms=True,
        further_endpoint="mxt_endpoint",
        command_resolution=COMMANDED,
    )

    def __init__(self, controller: MelfaR3, stream: SetPointStream, settings: MxtSettings) -> None:
        super().__init__(controller)
        self._stream = stream
        self._settings = settings
        self._feedback: Pose | None = None
        self._halted = False
        self._simulated = False
        self._timeout_read = False
        self._timeout_note = ""
        self._learner = self._nothing_learned()

    @classmethod
    def at(
        cls,
        endpoint: str,
        clock: Clock,
        sink: Sink | None = None,
        *,
        mxt_endpoint: str | None = None,
        stream_sink: Sink | None = None,
        guard: LinkGuard | None = None,
        **settings: Any,
    ) -> Self:
        """Return a driver for endpoints as the cell file writes them; nothing is opened yet.

        Args:
            endpoint: of the controller's R-protocol port.
            clock: time of the polls.
            sink: is shown all bytes of the R-protocol.
            mxt_endpoint: of the controller's real-time port.
            stream_sink: is shown all datagrams; `sink` by default.
            guard: of the arm; set points end with the program anyway, END lets the arm stand at once.
            settings: fields of `MxtSettings`; `stop_endpoint` as for `MelfaR3`.

        Raises:
            LinkError: an endpoint is missing or wrong.
            pydantic.ValidationError: a setting is unknown or wrong.
        """
        if mxt_endpoint is None:
            raise LinkError(
                "real-time control needs mxt_endpoint in [robot], the first element of the parameter NETPORT: "
                'mxt_endpoint = "udp://192.168.0.20:10000"'
            )
        for_controller, for_model = parted(settings, MxtSettings)
        controller = MelfaR3.at(endpoint, clock, sink, guard=guard, **for_controller)
        checked = MxtSettings(**for_model)
        datagrams = open_transport(mxt_endpoint, sink=stream_sink or sink)
        end = codec.encode(Command.END, 0)
        stream = SetPointStream(guarded(datagrams, guard, "mxt", end), clock, checked, name="robot (MXT)")
        return cls(controller, stream, checked)

    @property
    def own_program(self) -> str:
        """Name of the program that this driver has running on the controller; empty when the operator starts it."""
        return self._settings.program

    @property
    def notes(self) -> tuple[str, ...]:
        """What an operator should know about these connections; empty when all is as it should be."""
        lost = f"{self._stream.lost} answers to set points were lost" if self._stream.lost else ""
        return (*self._controller.notes, *filter(None, (lost, self._timeout_note, self._lag_note)))

    @property
    def lags_s(self) -> tuple[float | None, ...]:
        """How long each joint follows its set points behind, s, as this connection has shown; None: unknown."""
        return self._learner.lags_s

    @property
    def _lag_note(self) -> str:
        if self._learner.plausible or not self._settings.most_lead_ms:
            return ""
        return (
            f"the joints follow their set points by up to {1e3 * self._learner.difference_s:.1f} ms one behind the "
            f"other, more than most_lead_ms = {self._settings.most_lead_ms:g}: it is not made up for, and the beam "
            "misses by what they are apart"
        )

    async def connect(self) -> Identity:
        """Open the R-protocol's connections; the real-time port is asked when something is to move.

        Raises:
            WrongDeviceError: something else answers, or another robot.
            LinkError: unreachable or silent.
        """
        self._feedback = None
        self._timeout_read, self._timeout_note = False, ""
        self._learner = self._nothing_learned()
        identity = await self._controller.connect()
        self._simulated = identity.simulated
        try:
            # A STOP of an earlier run has left the program standing.
            self._halted = not (await self._controller.status()).running
        except BaseException:
            await uninterrupted(self.close())
            raise
        return identity

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._stream.close()
        await self._controller.close()

    async def joints(self) -> Pose:
        """Return the joints: the encoder feedback at the end of the last way while the arm still stands there.

        Raises:
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        reported = await self._controller.joints()
        feedback = self._feedback
        if feedback is None or off_target(reported, feedback, self._settings):
            return reported
        return feedback

    async def follow(self, way: Sequence[Pose]) -> None:
        """Lead the arm through all targets; return when it stands at the last one.

        No set point is sent twice on purpose. When the link fails on the way, the controller is asked where the robot
        is. A cancellation stops the robot before it goes on.

        Args:
            way: J1 deg, J2 deg, J3 mm, J4 deg of each target; the joints move linearly from one to the next.

        Raises:
            AlarmError: an alarm came up.
            NotReadyError: refused for a reason that an operator has to look at.
            NotArrivedError: the robot stands somewhere else.
            WrongDeviceError: the controller's cycle is shorter than the setting; nothing moves.
            LinkError: lost or silent; the robot has been stopped if it was moving.
            ProtocolError: garbage came.
            ValueError: no target, or a joint is not a finite number.
        """
        require_way(way)
        require_no_stop = self._controller.watch_stops()
        async with self._controller.guarded():
            try:
                await self._ready(require_no_stop)
                await self._lead(way, require_no_stop)
            except asyncio.CancelledError:
                await self.stop()
                raise

    async def stop(self) -> None:
        """Stop now over the R-protocol; see MelfaR3.stop. The program that takes set points stands afterwards."""
        self._halted = True
        self._feedback = None
        # A port that is not open leads nothing; the controller ends real-time control by its own time-out too.
        with contextlib.suppress(LinkError):
            self._stream.end()
        await self._controller.stop()

    async def _require_timeout(self) -> None:
        """Read MXTTOUT, once a connection: with it the arm stands when this program and its guard are gone.

        Raises:
            NotReadyError: it is too long and the arm is real.
        """
        if self._timeout_read:
            return
        values = await self.controller.read_parameter("MXTTOUT")
        count = parse_number(values[0], "MXTTOUT")
        timeout_s = count * self._settings.timeout_unit_s
        if not 0.0 <= timeout_s <= LONGEST_TIMEOUT_S:
            waits = "for ever" if count < 0.0 else f"{timeout_s:.3g} s"
            most = int(LONGEST_TIMEOUT_S / self._settings.timeout_unit_s)
            text = (
                f"{self._stream.where}: the controller waits {waits} for a set point (MXTTOUT = {count:g}): set "
                f"MXTTOUT to {most} at most and switch the controller off and on"
            )
            if not self._simulated:
                raise NotReadyError(f"{text}; nothing was moved", 0)
            self._timeout_note = text
        self._timeout_read = True

    async def _ready(self, permit: Callable[[], None]) -> None:
        await self._require_timeout()
        await self._controller.take_right()
        if not self._halted:
            return
        if not self._settings.program:
            raise RefusedError(
                f"{self._stream.where}: the program that takes set points stands after a stop: start it on the "
                "controller again, see docs/controller.md",
                0,
            )
        # A stop meanwhile sets it again.
        self._halted = False
        try:
            await self._controller.start_program(self._settings.program, permit)
        except BaseException:
            self._halted = True
            raise

    async def _lead(self, way: Sequence[Pose], require_no_stop: Callable[[], None]) -> None:
        bounds = await self._bounds()
        self._feedback = None
        trace = WayTrace()
        try:
            start = await self._stream.begin()
            points = self._set_points(start, way, bounds)
            await self._stream.send(_until_a_stop(points, require_no_stop), trace)
            reached = await self._rest(way[-1], require_no_stop, trace)
            self._stream.end()
        except (LinkError, ProtocolError) as lost:
            self._halted = True
            with contextlib.suppress(DeviceError):
                self._stream.end()
            await self._controller.account_for(way[-1], lost)
            return
        if off := off_target(reached, way[-1], self._settings):
            # The program may be stopped now.
            self._halted = True
            away = NotArrivedError(f"{self._stream.where}: the motion is over, but {off}: {LOOK_WHY}")
            await self._controller.account_for(way[-1], away)
            raise away
        require_unlocked(self._stream.where, await self._controller.status())
        self._feedback = reached
        self._learn(trace)

    def _set_points(self, start: Pose, way: Sequence[Pose], bounds: Bounds) -> list[Pose]:
        """Return what is sent, one a cycle.

        Raises:
            RefusedError: something of it would leave the way or be too fast; nothing has moved.
        """
        cycle_s = self._settings.mxt_cycle_ms / 1e3
        points = WayProfile(start, way, bounds).set_points(cycle_s, self._learner.delays_s)
        if trouble := excess(points, start, way, bounds, cycle_s):
            self._stream.end()
            raise RefusedError(f"{self._stream.where}: {trouble}; nothing was moved", 0)
        return points

    def _nothing_learned(self) -> LagLearner:
        return LagLearner(self._settings.mxt_cycle_ms / 1e3, self._settings.most_lead_ms / 1e3)

    def _learn(self, trace: WayTrace) -> None:
        before = self._learner.lags_s
        self._learner.take(trace)
        if [lag is None for lag in before] != [lag is None for lag in self._learner.lags_s]:
            lags = ", ".join("?" if lag is None else f"{1e3 * lag:.2f}" for lag in self._learner.lags_s)
            delays = ", ".join(f"{1e3 * delay:.2f}" for delay in self._learner.delays_s)
            _log.info(
                "%s: the joints follow %s ms behind their set points, which are delayed by %s ms now",
                self._stream.where,
                lags,
                delays,
            )

    async def _bounds(self) -> Bounds:
        """Return what the joints may do at the override that the controller reads back."""
        share = (await self._controller.status()).override_percent / 100.0
        settings = self._settings
        turn, lift = settings.follow_speed_deg_s, settings.follow_speed_mm_s
        j1, j2, j3, j4 = (
            min(a, share * b) for a, b in zip((turn, turn, lift, turn), settings.full_speed, strict=True)
        )
        fast, slow = settings.follow_acceleration_deg_s2, settings.follow_acceleration_mm_s2
        return Bounds((j1, j2, j3, j4), (fast, fast, slow, fast))

    async def _rest(self, target: Pose, require_no_stop: Callable[[], None], trace: WayTrace) -> Pose:
        """Hold the last set point until the feedback stays the same."""
        still = 0
        last: Pose | None = None
        try:
            async with asyncio.timeout(self._settings.arrival_timeout_s):
                while True:
                    feedback = await self._stream.send(_until_a_stop((target,), require_no_stop), trace)
                    if feedback is None:
                        continue
                    still = still + 1 if last is not None and _near(feedback, last) else 0
                    if still >= _REST_CYCLES:
                        return feedback
                    last = feedback
        except TimeoutError:
            raise LinkTimeoutError(
                f"{self._stream.where}: the arm does not come to rest within "
                f"{self._settings.arrival_timeout_s:g} s, last feedback {last}: check what moves it"
            ) from None


def _near(one: Pose, other: Pose) -> bool:
    return all(abs(a - b) < _REST_DEG for a, b in zip(one, other, strict=True))


def _until_a_stop(points: Iterable[Pose], require_no_stop: Callable[[], None]) -> Iterator[Pose]:
    """Hand out set points; none once a stop has begun, which does not wait for the end of the way.

    Raises:
        RefusedError: a stop has begun.
    """
    for point in points:
        require_no_stop()
        yield point
