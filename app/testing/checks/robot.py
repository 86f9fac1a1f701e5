"""What keeps people and machines whole in a robot's driver.

Motions are small and slow: the first axis by 3 degrees at 1 % override.
"""

import asyncio
import contextlib
import math
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from catseye.app.cell.arm import shipped_arm
from catseye.app.cell.axes import axes_of
from catseye.app.testing.checks.check import Check
from catseye.app.testing.trial import Trial, expect
from catseye.drivers.roles.device import Role
from catseye.drivers.roles.errors import DeviceError, NotReadyError
from catseye.drivers.roles.pose import Axes, with_axis

_ROLES: tuple[Role, ...] = ("robot",)
_OVERRIDE_PERCENT = 1.0
_WAY_DEG = 3.0
_UNDER_WAY_S = 0.2
_STOP_S = 3.0
_SAME_DEG = 0.05
_LOOK_S = 0.2
_SETTLE_S = 0.05
_POLL_S = 0.02
_BEYOND = 50.0


def _axes(trial: Trial) -> Axes:
    return axes_of(shipped_arm(trial.candidate.arm), {})


async def status_has_the_state(trial: Trial) -> None:
    """`status` has the fields of a controller's state, and `joints` a finite number for each axis."""
    async with trial.connected() as driver:
        status = await trial.in_time(driver.status(), "status()")
        flags = (status.servo_on, status.running, status.emergency_stop, status.teach_mode)
        expect(
            all(isinstance(flag, bool) for flag in flags), f"every flag of {status!r} has to be True or False"
        )
        expect(math.isfinite(status.override_percent), f"override_percent is {status.override_percent!r}")
        expect(isinstance(status.alarm_number, int), f"alarm_number is {status.alarm_number!r}; 0 means none")
        joints = await trial.ask(driver)
        expect(
            len(joints) == len(_axes(trial)) and all(map(math.isfinite, joints)),
            f"joints() returned {joints!r}",
        )


async def connecting_moves_nothing(trial: Trial) -> None:
    """`connect` and the questions switch no drive on and begin no motion."""
    servo = trial.device.arm().servo
    async with trial.connected() as driver:
        await trial.in_time(driver.status(), "status()")
        await trial.ask(driver)
        switched = trial.device.arm().servo != servo
        expect(not switched, "the drives were switched by connect(): wait for servo(on=True)")
        expect(trial.motions() == [], f"the arm has moved after connect(): {trial.motions()}")


async def a_motion_arrives(trial: Trial) -> None:
    """`move_joints` is commanded once and returns when the robot stands at the target."""
    async with _ready(trial) as driver:
        target = _aside(await trial.ask(driver))
        await driver.move_joints(target)
        joints = await trial.ask(driver)
        off_deg = max(abs(a - b) for a, b in zip(joints, target, strict=True))
        expect(
            off_deg < _SAME_DEG, f"move_joints() has returned {off_deg:.3f} beside the target, at {joints}"
        )
        if trial.bench is not None:
            expect(len(trial.motions()) == 1, f"one motion was asked for, the arm did {trial.motions()}")
            # The last set point of a stream may end with its cycle.
            await asyncio.sleep(_SETTLE_S)
            expect(not trial.device.arm().moving, "move_joints() has returned, and the arm still moves")


async def stop_ends_a_motion(trial: Trial) -> None:
    """`stop` overtakes the motion under way, returns at the standstill, and no motion follows."""
    async with _ready(trial) as driver:
        target = _aside(await trial.ask(driver))
        moving = await _set_off(trial, driver, target)
        started_s = time.monotonic()
        await driver.stop()
        took_s = time.monotonic() - started_s
        expect(took_s < _STOP_S, f"stop() took {took_s:.1f} s")
        await _expect_standstill(trial, driver)
        await _ended(trial, moving)
        if trial.bench is not None:
            expect(
                any(text.startswith("stop") for text in trial.deeds()), f"no STOP arrived: {trial.deeds()}"
            )
            expect(len(trial.motions()) == 1, f"after stop() the arm did {trial.motions()}")


async def a_cancelled_motion_is_stopped(trial: Trial) -> None:
    """A cancelled `move_joints` stops the robot before it passes the cancellation on."""
    async with _ready(trial) as driver:
        moving = await _set_off(trial, driver, _aside(await trial.ask(driver)))
        moving.cancel()
        await _ended(trial, moving)
        expect(moving.cancelled(), "move_joints() swallowed the cancellation: let CancelledError pass")
        await _expect_standstill(trial, driver)
        if trial.bench is not None:
            expect(len(trial.motions()) == 1, f"after the cancellation the arm did {trial.motions()}")


async def stop_at_rest_is_harmless(trial: Trial) -> None:
    """`stop` may be called at any time, twice, and also when nothing moves."""
    async with _ready(trial) as driver:
        await trial.in_time(driver.stop(), "stop()")
        await trial.in_time(driver.stop(), "the second stop()")
        await _expect_standstill(trial, driver)


async def a_lost_answer_never_repeats_a_motion(trial: Trial) -> None:
    """When the link breaks under a motion and the answer is lost, the motion is not commanded again."""
    async with _ready(trial) as driver:
        moving = await _set_off(trial, driver, _aside(await trial.ask(driver)))
        trial.mute()
        await asyncio.sleep(_UNDER_WAY_S)
        trial.drop()
        trial.release()
        await _ended(trial, moving)
        await trial.ask_after_trouble(driver)
        await asyncio.sleep(_LOOK_S)
        expect(
            len(trial.motions()) == 1, f"the answer to one motion was lost, and the arm did {trial.motions()}"
        )


async def stop_works_on_a_broken_link(trial: Trial) -> None:
    """`stop` reaches the controller also when the links have just broken under a motion."""
    async with _ready(trial) as driver:
        moving = await _set_off(trial, driver, _aside(await trial.ask(driver)))
        trial.drop()
        await trial.in_time(driver.stop(), "stop()")
        await _ended(trial, moving)
        expect(not trial.device.arm().moving, "stop() has returned, and the arm still moves")


async def targets_beyond_the_limits_are_refused(trial: Trial) -> None:
    """A target that the controller refuses is an error with a text, and nothing moves."""
    async with _ready(trial) as driver:
        axes = _axes(trial)
        # The emulated quill stands at its end, so that a driver that streams set points meets the limit at once.
        number = next((n for n, axis in enumerate(axes) if axis.unit == "mm"), 0)
        beyond = with_axis(await trial.ask(driver), number, axes[number].low - _BEYOND)
        await _refused(trial, driver, beyond, DeviceError, ValueError)


async def a_target_that_is_no_number_is_refused(trial: Trial) -> None:
    """NaN and infinity are ValueErrors before anything is sent."""
    async with _ready(trial) as driver:
        joints = await trial.ask(driver)
        for value in (math.nan, math.inf):
            await _refused(trial, driver, (value, *joints[1:]), ValueError)


async def overrides_out_of_range_are_refused(trial: Trial) -> None:
    """An override outside of 1...100 % is a ValueError; what is returned is what the controller reads back."""
    async with _ready(trial) as driver:
        for percent in (0.0, 101.0, -5.0):
            try:
                await driver.set_override(percent)
            except ValueError:
                continue
            expect(False, f"set_override({percent:g}) was accepted")
        back = await driver.set_override(_OVERRIDE_PERCENT)
        expect(back == _OVERRIDE_PERCENT, f"set_override({_OVERRIDE_PERCENT:g}) returned {back!r}")


async def an_alarm_is_reported(trial: Trial) -> None:
    """A motion in alarm is refused with the alarm's number, and `status` gives it with a text."""
    async with _ready(trial) as driver:
        target = _aside(await trial.ask(driver))
        trial.device.fault("alarm", number=50)
        status = await trial.in_time(driver.status(), "status()")
        told = status.alarm_number == 50 if driver.abilities.numbers_alarms else status.alarm_number != 0
        expect(told and bool(status.alarm_text), f"alarm 50 is active, and status() is {status!r}")
        await _refused(trial, driver, target, DeviceError)


@asynccontextmanager
async def _ready(trial: Trial) -> AsyncIterator[Any]:
    """Yield a connected driver of a robot that is ready to move slowly; its drives are off again at the end."""
    async with trial.connected() as driver:
        await trial.in_time(driver.servo(on=True), "servo(on=True)")
        try:
            await trial.in_time(driver.set_override(_OVERRIDE_PERCENT), "set_override()")
            yield driver
        finally:
            if not trial.candidate.emulated:
                if trial.bench is not None:
                    trial.device.clear_faults()
                # Where no command switches the drives, an operator does.
                with contextlib.suppress(NotReadyError):
                    await trial.in_time(driver.servo(on=False), "servo(on=False)")


async def _set_off(trial: Trial, driver: Any, target: tuple[float, ...]) -> "asyncio.Task[None]":
    """Begin a motion; return when it is under way, as far as that can be seen, or has failed."""
    moving = asyncio.create_task(driver.move_joints(target))
    end_s = time.monotonic() + trial.candidate.patience_s
    await asyncio.sleep(_UNDER_WAY_S)
    if trial.bench is not None:
        # No event of this loop: the arm moves in another thread.
        while time.monotonic() < end_s:
            if trial.device.arm().moving or moving.done():
                break
            await asyncio.sleep(_POLL_S)
    return moving


async def _ended(trial: Trial, moving: "asyncio.Task[None]") -> None:
    """Wait for the end of a motion's task: by an error of the driver, by cancellation, or at the target."""
    done, _ = await asyncio.wait({moving}, timeout=trial.candidate.patience_s)
    expect(bool(done), "move_joints() did not end although the motion is over")
    error = None if moving.cancelled() else moving.exception()
    known = error is None or isinstance(error, DeviceError)
    expect(known, f"move_joints() ended with {error!r}: errors of the instrument are DeviceErrors")


async def _expect_standstill(trial: Trial, driver: Any) -> None:
    first = await trial.ask(driver)
    await asyncio.sleep(_LOOK_S)
    second = await trial.ask(driver)
    still = max(abs(a - b) for a, b in zip(first, second, strict=True)) < _SAME_DEG
    expect(still, f"the robot still moves: {first}, then {second}")


async def _refused(trial: Trial, driver: Any, target: tuple[float, ...], *errors: type[Exception]) -> None:
    before = trial.motions() if trial.bench is not None else []
    try:
        await trial.in_time(driver.move_joints(target), "move_joints()")
    except errors as error:
        expect(len(str(error)) > 20, f"the text says too little: {error}")
    else:
        expect(False, f"move_joints({target}) was accepted: raise {' or '.join(e.__name__ for e in errors)}")
    if trial.bench is not None:
        expect(trial.motions() == before, f"the target was refused, and the arm did {trial.motions()}")


def _aside(joints: tuple[float, ...]) -> tuple[float, ...]:
    return (joints[0] + _WAY_DEG, *joints[1:])


CHECKS = (
    Check(status_has_the_state, _ROLES),
    Check(connecting_moves_nothing, _ROLES, ("bench",)),
    Check(a_motion_arrives, _ROLES, ("motion",)),
    Check(stop_ends_a_motion, _ROLES, ("motion",)),
    Check(a_cancelled_motion_is_stopped, _ROLES, ("motion",)),
    Check(stop_at_rest_is_harmless, _ROLES, ("motion",)),
    Check(a_lost_answer_never_repeats_a_motion, _ROLES, ("motion", "bench", "proxy")),
    Check(stop_works_on_a_broken_link, _ROLES, ("motion", "bench", "proxy")),
    Check(targets_beyond_the_limits_are_refused, _ROLES, ("motion", "bench")),
    Check(a_target_that_is_no_number_is_refused, _ROLES, ("motion",)),
    Check(overrides_out_of_range_are_refused, _ROLES, ("motion",)),
    Check(an_alarm_is_reported, _ROLES, ("motion", "bench")),
)
