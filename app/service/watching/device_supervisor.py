"""One device between runs: connected, asked again and again, connected anew when it is lost."""

import asyncio
import logging
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass

from catseye.app.engine.waiting import cancel, within
from catseye.app.service.watching.latest_values import LatestValues
from catseye.app.service.watching.observed_devices import (
    ObservedDevice,
    ObservedInterferometer,
    ObservedIo,
    ObservedRobot,
    ObservedSensor,
    ObservedTracker,
)
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError, LinkError, ProtocolError

_log = logging.getLogger(__name__)

Question = Callable[[], Awaitable[object]]

ROBOT_S = 0.25
BEAM_S = 0.1
STREAMED_BEAM_S = 0.25
DOOR_S = 0.5
AIR_S = 2.0
TRACKER_S = 5.0
"""Real seconds between two rounds of questions."""

FIRST_PAUSE_S = 0.5
LONGEST_PAUSE_S = 10.0
"""Real seconds until a lost device is connected anew; each attempt doubles them."""

CLOSE_LIMIT_S = 5.0
"""Real seconds for a driver to let its link go."""

_HELD = "its driver did not let the link go"

_ROUND_LIMIT_S = 1.0
"""Real seconds for the questions under way: a link that is closed between two answers is closed properly."""


@dataclass(frozen=True)
class Round:
    """Questions that are asked one after another, again and again.

    Attributes:
        period_s: from one round to the next, real s.
        questions: of a round; none for a device that only stays connected.
    """

    period_s: float
    questions: tuple[Question, ...] = ()


def round_for(device: ObservedDevice) -> Round:
    """Return what is asked of a device."""
    match device:
        case ObservedRobot():
            torques = (device.torques,) if device.abilities.torques else ()
            return Round(ROBOT_S, (device.status, device.joints, *torques))
        case ObservedInterferometer(streams=True):
            return Round(STREAMED_BEAM_S, (device.status,))
        case ObservedInterferometer():
            return Round(BEAM_S, (device.read, device.status))
        case ObservedSensor():
            return Round(AIR_S, (device.sample,))
        case ObservedIo():
            return Round(DOOR_S, (device.door_closed,))
        case ObservedTracker() if not (device.abilities.points or device.abilities.poses):
            return Round(TRACKER_S, (device.locate,))
    return Round(AIR_S)


class DeviceSupervisor:
    """Keeps one device connected and asks it for its values.

    Args:
        device: that is kept.
        latest: takes what becomes of the link.
        clock: real time.

    Attributes:
        device: that is kept.
        name: of the device in the cell file.
        asking: held while a round of questions is under way; whoever else holds it keeps the device for himself.
        connected: it answered when it was connected and has not been lost since.
    """

    def __init__(self, device: ObservedDevice, latest: LatestValues, clock: Clock) -> None:
        self.name = device.name
        self.asking = asyncio.Lock()
        self.connected = False
        self.device = device
        self._latest = latest
        self._clock = clock
        self._round = round_for(device)
        self._task: asyncio.Task[None] | None = None
        self._closing: asyncio.Task[None] | None = None
        self._ended = asyncio.Event()

    def begin(self) -> None:
        """Keep the device from now on."""
        self._ended.clear()
        self._task = asyncio.create_task(self._keep())

    async def let_go(self) -> str:
        """Disconnect and ask no more; return why the link is not known to be free, empty when it is."""
        self._ended.set()
        self.connected = False
        if self._task is not None:
            # Not in the middle of an answer, if it comes soon; and not for ever, if it does not.
            with suppress(TimeoutError):
                await within(self._clock, _ROUND_LIMIT_S, self._between_rounds())
            await cancel(self._task)
            self._task = None
        return await self._close()

    async def _close(self) -> str:
        """Close the driver; a closing that hangs goes on, and is waited for again the next time."""
        if self._closing is None:
            self._closing = asyncio.create_task(self.device.close())
        timer = asyncio.create_task(self._clock.sleep(CLOSE_LIMIT_S))
        try:
            await asyncio.wait({self._closing, timer}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            await cancel(timer)
        if not self._closing.done():
            return f"{self.name}: the driver does not let its link go ({CLOSE_LIMIT_S:g} s)"
        if error := self._closing.exception():
            _log.warning("%s was not closed properly: %s", self.name, error)
        self._closing = None
        return ""

    async def _between_rounds(self) -> None:
        async with self.asking:
            return

    async def _keep(self) -> None:
        """Connect, ask until the device is lost, pause, and so on."""
        pause_s = FIRST_PAUSE_S
        while not self._ended.is_set():
            why = await self._connected_rounds() if self._closing is None else _HELD
            if self.connected:
                pause_s = FIRST_PAUSE_S
            self.connected = False
            if self._ended.is_set():
                return
            stuck = await self._close()
            self._latest.lost(self.name, stuck or why)
            await self._clock.sleep(pause_s)
            pause_s = min(2.0 * pause_s, LONGEST_PAUSE_S)

    async def _connected_rounds(self) -> str:
        """Ask round after round; return how the device was lost."""
        try:
            await self.device.connect()
            # A cancellation that comes together with an answer may be lost on its way through a library.
            while not self._ended.is_set():
                async with self.asking:
                    await self._ask()
                self.connected = True
                await self._clock.sleep(self._round.period_s)
        except DeviceError as error:
            return str(error)
        except Exception as error:  # noqa: BLE001  # one broken driver hides no other device
            _log.exception("%s: its driver failed", self.name)
            return f"{type(error).__name__}: {error}"
        return ""

    async def _ask(self) -> None:
        for question in self._round.questions:
            try:
                await question()
            except (LinkError, ProtocolError):
                raise
            except DeviceError:
                # A refusal is an answer: there is no beam, or an alarm.
                continue
