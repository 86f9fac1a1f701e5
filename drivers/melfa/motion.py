"""Parts of a joint motion: its command, the comparison of reported joints with it, waiting for standstill."""

import asyncio
import contextlib
from collections.abc import Awaitable, Callable, Iterator, Mapping
from typing import Final

from catseye.drivers.links.healing import ATTEMPTS
from catseye.drivers.melfa.codec import State
from catseye.drivers.melfa.session import Session
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.melfa.side import Side
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import (
    AlarmError,
    DeviceError,
    LinkError,
    LinkTimeoutError,
    NotArrivedError,
    NotReadyError,
    NotSentError,
    ProtocolError,
    RefusedError,
)
from catseye.drivers.roles.pose import Pose, Unit
from catseye.drivers.roles.robot import RobotStatus

VARIABLES = tuple(f"JCATSEY{number}" for number in range(1, 9))
"""Joint variables that may carry the target in the controller. A session takes one of them: what another program
assigns is not where this one drives, and the controller, which keeps its variables, is not filled with names."""

COMMANDED: Final[Mapping[Unit, float]] = {"deg": 1e-3, "mm": 1e-3}
"""Steps in which a controller drives (SCARA paper, robot data; µm of J3)."""

REPORTED: Final[Mapping[Unit, float]] = {"deg": 1e-2, "mm": 1e-2}
"""Steps in which the R-protocol tells where joints stand (sheet 1.11): nothing finer can be added to them."""

NO_TORQUES = (
    "a MELFA controller tells currents of the motors, likely in per cent of the rated ones, and nobody says what "
    "torque belongs to them"
)

JOINT_NAMES = ("J1", "J2", "J3", "J4")
LOCKED = (
    "the controller's machine lock is on: it reports motions that the arm does not make; switch it off at the "
    "controller, then go on"
)
LOOK_WHY = "look for a collision, a stop by another source or an alarm before moving again"

STILL_POLLS = 3
"""Equal positions in a row that count as standstill."""

LOOK_S = 0.2
"""Between two looks at an arm whose motion is not answered yet, real s."""

STILL_LOOKS = 5
"""Equal looks in a row after which an answer counts as lost: a second, within the two that it may take to notice."""

_LOOK_S = 3.0
"""For one look at an arm whose motion's answer is lost, real s; then it is stopped."""

_JOINT_UNITS = ("deg", "deg", "mm", "deg")

_START_TIME_S = 0.5
_NETWORK_POLL_S = 0.02
_POLL_BYTES = 130
_FEWEST_POLLS = 4


def assignment(variable: str, target: Pose) -> str:
    """Return the statement that sets a variable: four decimals, never a negative zero (sheet 4.2)."""
    values = ",".join(f"{round(value, 4) + 0.0:.4f}" for value in target)
    return f"{variable}=({values})"


def off_target(reached: Pose, target: Pose, settings: MelfaSettings) -> str:
    """Return the joints that are reported off the target, in words; empty when all are there."""
    limits = {"deg": settings.tolerance_deg, "mm": settings.tolerance_mm}
    return ", ".join(
        f"{name} is at {at:.2f} {unit} instead of {to:.4f} {unit}"
        for name, unit, at, to in zip(JOINT_NAMES, _JOINT_UNITS, reached, target, strict=True)
        if abs(at - to) > limits[unit]
    )


def unstarted_polls(byte_s: float) -> int:
    """Return how many equal positions in a row say that a motion which was started has ended or never began.

    They span half a second: 25 polls over a network, fewer on a serial line, where the bytes of one poll take longer.

    Args:
        byte_s: time of one byte on a serial line, real s; 0 on a network.
    """
    return max(_FEWEST_POLLS, round(_START_TIME_S / (_NETWORK_POLL_S + _POLL_BYTES * byte_s)))


@contextlib.contextmanager
def asking_under_way() -> Iterator[None]:
    """Turn the refusal of a question while the arm may move into garbage, which is accounted for.

    A line that garbles bytes makes controllers refuse what they always answer.

    Raises:
        ProtocolError: a question was refused.
        AlarmError: an alarm is the reason.
    """
    try:
        yield
    except AlarmError:
        raise
    except RefusedError as exc:
        raise ProtocolError(f"a question was refused while the arm may move: {exc}") from exc


def require_unlocked(where: str, state: State | RobotStatus) -> None:
    """Check that the arm makes the motions that the controller reports (sheet 1.10, bit of the run status).

    Raises:
        NotReadyError: it does not.
    """
    if state.machine_locked:
        raise NotReadyError(f"{where}: {LOCKED}", 0)


async def sent_once(prepare: Callable[[], Awaitable[None]], send: Callable[[], Awaitable[None]]) -> None:
    """Prepare something and send it; do both again as long as the link keeps it back.

    Args:
        prepare: is harmless.
        send: raises NotSentError only where nothing was sent.

    Raises:
        NotSentError: it is kept back again and again; nothing was sent.
    """
    for attempt in range(1, ATTEMPTS + 1):
        await prepare()
        try:
            await send()
        except NotSentError:
            if attempt == ATTEMPTS:
                raise
        else:
            return


async def standstill(
    session: Session,
    clock: Clock,
    settings: MelfaSettings,
    *,
    timeout_s: float,
    still_polls: int,
    target: Pose | None = None,
    before_look: Callable[[], Awaitable[None]] | None = None,
) -> Pose:
    """Poll until nothing runs and the joints stay the same, or stand at the target.

    The run bit alone is not enough: no source says whether it covers statements that are executed directly.

    Args:
        timeout_s: for all polls together, real s.
        still_polls: equal positions in a row that count as standstill.
        target: of the motion, if one was started.
        before_look: is called before each poll.

    Returns:
        The joints at standstill.

    Raises:
        LinkTimeoutError: still moving.
        NotReadyError: a motion was started and the machine is locked.
        ProtocolError: a question was refused, which a line that garbles bytes does.
        DeviceError: the controller does not answer as it should.
    """
    last: Pose | None = None
    equal = 0
    try:
        async with asyncio.timeout(timeout_s):
            while True:
                if before_look is not None:
                    await before_look()
                with asking_under_way():
                    state, joints = await session.state(), await session.joints()
                if target:
                    require_unlocked(session.where, state)
                running = state.running
                if target and not running and not off_target(joints, target, settings):
                    return joints
                equal = equal + 1 if joints == last and not running else 1
                if equal >= still_polls:
                    return joints
                last = joints
                await clock.sleep(settings.poll_s)
    except TimeoutError:
        raise LinkTimeoutError(
            f"{session.where}: the robot does not stand still after {timeout_s:g} s, last joints {last}: "
            "check what moves it"
        ) from None


async def answered(motion: Awaitable[None], asker: Side) -> None:
    """Await the answer of a motion; look meanwhile whether the arm stands without one.

    Args:
        motion: ends with the answer, or raises its error; cancelled where the arm stands without one.
        asker: is not blocked by the motion.

    Raises:
        LinkTimeoutError: the arm stands and no answer has come.
    """
    look = _Look(asker)
    try:
        async with asyncio.timeout(None) as patience:
            look.begin_later(patience)
            await motion
    except asyncio.CancelledError:
        # STOP comes next, and waits for no look.
        look.give_up()
        raise
    except TimeoutError:
        if not patience.expired():
            raise
        raise LinkTimeoutError(f"{asker.where}: the arm stands and the motion is not answered") from None
    finally:
        await look.end()


class _Look:
    """Looks at an arm whose motion takes longer than a moment; a short one costs no task.

    Args:
        asker: is not blocked by the motion.
    """

    def __init__(self, asker: Side) -> None:
        self._asker = asker
        self._over = asyncio.Event()
        self._timer: asyncio.TimerHandle | None = None
        self._task: asyncio.Task[None] | None = None

    def begin_later(self, patience: asyncio.Timeout) -> None:
        """Begin to look after a moment; the timeout expires when the arm has stood for a while."""
        self._timer = asyncio.get_running_loop().call_later(LOOK_S, self._begin, patience)

    def _begin(self, patience: asyncio.Timeout) -> None:
        self._task = asyncio.create_task(self._until_standing(patience))

    def give_up(self) -> None:
        """Break off the look under way; its link is out of step then."""
        if self._task is not None:
            self._task.cancel()

    async def end(self) -> None:
        """Look no more; a look under way is let to its end, so that its link stays in step."""
        if self._timer is not None:
            self._timer.cancel()
        if self._task is None:
            return
        self._over.set()
        try:
            await asyncio.wait({self._task}, timeout=LOOK_S)
        finally:
            self._task.cancel()
            await asyncio.wait({self._task})

    async def _until_standing(self, patience: asyncio.Timeout) -> None:
        last: Pose | None = None
        still = 0
        while still < STILL_LOOKS and not self._over.is_set():
            try:
                running, joints = (await self._asker.state()).running, await self._asker.joints()
            except DeviceError:
                # What cannot be seen now is no reason to give up a motion whose answer may come.
                still, last = 0, None
            else:
                still = still + 1 if joints == last and not running else 0
                last = joints
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(LOOK_S):
                    await self._over.wait()
        # The answer may have come at the very moment.
        if not self._over.is_set():
            patience.reschedule(asyncio.get_running_loop().time())


async def account_for(
    asker: Side,
    clock: Clock,
    settings: MelfaSettings,
    target: Pose,
    lost: DeviceError,
    stop: Callable[[], Awaitable[None]],
    *,
    still_polls: int,
) -> None:
    """Ask where the robot is after the answer to a motion was lost; go on only if it stands at the target.

    An arm that still approaches its target is waited for.

    Args:
        asker: is not blocked by the motion.
        target: joints of the motion, deg or mm.
        still_polls: equal positions in a row that count as standstill elsewhere.

    Raises:
        AlarmError: an alarm is the reason.
        NotReadyError: the machine is locked, and where the robot stands is not known; a STOP was sent.
        NotArrivedError: the robot stands somewhere else or leaves its way; a STOP was sent.
        LinkError: the controller does not say; a STOP was sent.
    """
    try:
        async with asyncio.timeout(settings.move_timeout_s):
            status, off = await _followed(asker, clock, settings, target, still_polls)
    except (DeviceError, TimeoutError) as exc:
        await stop()
        why = str(exc) or "no answer in time, or it moves for too long"
        raise LinkError(
            f"{asker.where}: the answer to the motion is lost ({lost}) and the controller does not say "
            f"where the robot is ({why}): the robot was told to stop; {LOOK_WHY}"
        ) from lost
    if not off and not status.alarm_number and not status.machine_locked:
        return
    await stop()
    require_unlocked(asker.where, status)
    if status.alarm_number:
        raise AlarmError(f"{asker.where}: {status.alarm_text}", status.alarm_number) from lost
    raise NotArrivedError(
        f"{asker.where}: the answer to the motion is lost ({lost}); the robot "
        f"{'moves' if status.running else 'stands'} elsewhere ({off}) and was told to stop: {LOOK_WHY}"
    ) from lost


async def _followed(
    asker: Side, clock: Clock, settings: MelfaSettings, target: Pose, still_polls: int
) -> tuple[RobotStatus, str]:
    """Look until the arm stands, or no longer approaches its target; return its state and what is off."""
    last: Pose | None = None
    still = 1
    while True:
        async with asyncio.timeout(_LOOK_S):
            status, joints = await asker.status(), await asker.joints()
        off = off_target(joints, target, settings)
        still = still + 1 if joints == last else 1
        # A program that waits for the next way counts as running too: then only the joints show it.
        stands = not off and (not status.running or still >= STILL_POLLS)
        leaves = last is not None and _leaves(last, joints, target, settings)
        if status.alarm_number or stands or leaves or still >= still_polls:
            return status, off
        last = joints
        await clock.sleep(settings.poll_s)


def _leaves(before: Pose, now: Pose, target: Pose, settings: MelfaSettings) -> bool:
    """Return whether a joint has gone away from its target: all of them go straight to theirs."""
    limits = (settings.tolerance_deg, settings.tolerance_deg, settings.tolerance_mm, settings.tolerance_deg)
    return any(
        abs(at - to) > abs(was - to) + limit
        for was, at, to, limit in zip(before, now, target, limits, strict=True)
    )
