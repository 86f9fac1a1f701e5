"""What a measurement relies on in a length counter's driver."""

import asyncio
import contextlib
import math
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import Any

from catseye.app.testing.checks.check import Check
from catseye.app.testing.trial import Trial, expect
from catseye.drivers.roles.device import Role
from catseye.drivers.roles.errors import DeviceError

_ROLES: tuple[Role, ...] = ("interferometer",)
_SHIFT_MM = 0.5
_SAME_MM = 0.01
_IN_FLIGHT_S = 0.05
_TRIES = 40
_INTERRUPTION_S = 0.02
"""Of bench time; a hand in the beam takes longer."""


async def it_says_who_corrects_for_the_air(trial: Trial) -> None:
    """`compensated` says `none` or `instrument`, so that nothing is corrected twice."""
    said = trial.new_driver().compensated
    expect(said in {"none", "instrument"}, f"compensated is {said!r}, it has to be 'none' or 'instrument'")


async def status_and_reading_agree(trial: Trial) -> None:
    """Readings are finite lengths, the signal lies in 0...1, and both count from the same zero."""
    async with trial.connected() as driver:
        reading, status = await trial.ask(driver), await trial.in_time(driver.status(), "status()")
        expect(math.isfinite(reading.displacement_mm), f"displacement_mm is {reading.displacement_mm!r}")
        expect(math.isfinite(reading.time_s), f"time_s is {reading.time_s!r}")
        expect(0.0 <= status.signal <= 1.0, f"the signal is {status.signal!r}, it has to lie in 0...1")
        flags = (status.beam_ok, status.beam_lost, status.overspeed, status.laser_ready)
        expect(
            all(isinstance(flag, bool) for flag in flags), f"every flag of {status!r} has to be True or False"
        )
        same = reading.zero_id == status.zero_id
        expect(same, f"read() and status() refer to different zeros: {reading!r}, {status!r}")


async def zeros_are_numbered(trial: Trial) -> None:
    """Each `zero` returns a higher number than the one before; readings carry the last one."""
    async with trial.connected() as driver:
        numbers = [await _zero(trial, driver) for _ in range(3)]
        expect(
            numbers == sorted(set(numbers)),
            f"the numbers of three zeros are {numbers}: they have to increase",
        )
        reading = await trial.ask(driver)
        expect(reading.zero_id == numbers[-1], f"{reading!r} after zero {numbers[-1]}")


async def zeros_are_numbered_on_over_a_new_link(trial: Trial) -> None:
    """A zero after the link was opened again, or the driver connected again, has a number that never was before."""
    driver = trial.new_driver()
    numbers = []
    try:
        for _ in range(2):
            await trial.in_time(driver.connect(), "connect()")
            numbers.append(await _zero(trial, driver))
            trial.drop()
            await asyncio.sleep(_IN_FLIGHT_S)
            await trial.ask_after_trouble(driver)
            numbers.append(await _zero(trial, driver))
            await trial.in_time(driver.close(), "close()")
    finally:
        await driver.close()
    rise = numbers == sorted(set(numbers))
    expect(
        rise, f"the numbers of zeros over new links are {numbers}: they have to increase, also over connect()"
    )


async def a_zero_makes_the_count_zero(trial: Trial) -> None:
    """The first reading after a zero is zero."""
    async with trial.connected() as driver, _reflector(trial) as shift:
        await _zero(trial, driver)
        way_mm = shift(_SHIFT_MM)
        await _expect_mm(trial, driver, way_mm, "after the reflector moved away")
        await _zero(trial, driver)
        await _expect_mm(trial, driver, 0.0, "after a zero")


async def the_displacement_grows_with_the_beam(trial: Trial) -> None:
    """A longer beam is a larger displacement, in mm."""
    async with trial.connected() as driver, _reflector(trial) as shift:
        await _zero(trial, driver)
        way_mm = shift(_SHIFT_MM)
        await _expect_mm(trial, driver, way_mm, "after the reflector moved away")
        back_mm = way_mm + shift(-2.0 * _SHIFT_MM)
        await _expect_mm(trial, driver, back_mm, "after the reflector came nearer")


async def a_late_answer_belongs_to_no_question(trial: Trial) -> None:
    """After a stall the next reading is of now, not the late answer to an older question."""
    async with trial.connected() as driver, _reflector(trial) as shift:
        await _zero(trial, driver)
        trial.stall()
        with contextlib.suppress(DeviceError):
            await trial.ask(driver)
        way_mm = shift(_SHIFT_MM)
        trial.release()
        reading = await trial.ask_after_trouble(driver)
        expect(
            abs(reading.displacement_mm - way_mm) < _SAME_MM,
            f"{reading.displacement_mm} mm came after a stall, {way_mm:.4f} mm are right: drain the link and drop "
            "what is late before the next request",
        )


async def a_lost_beam_is_latched_until_the_next_zero(trial: Trial) -> None:
    """A beam that returns does not revive the count: `beam_lost` stays until a zero."""
    async with trial.connected() as driver:
        await _zero(trial, driver)
        status = await trial.in_time(driver.status(), "status()")
        expect(
            status.beam_ok and not status.beam_lost,
            f"the beam returns after a zero, and status() is {status!r}",
        )
        trial.device.fault("block_beam")
        status = await _status_with(trial, driver, beam_ok=False)
        expect(status.beam_lost, f"the beam is interrupted, and status() is {status!r}")
        trial.device.clear_faults()
        status = await _status_with(trial, driver, beam_ok=True)
        expect(
            status.beam_lost,
            f"the beam is back and has revived the count: {status!r}: keep beam_lost latched",
        )
        await _zero(trial, driver)
        status = await trial.in_time(driver.status(), "status()")
        expect(not status.beam_lost, f"beam_lost is still set after a zero: {status!r}")


async def a_beam_lost_between_two_questions_is_seen(trial: Trial) -> None:
    """An interruption that is over before anybody asks is latched all the same."""
    async with trial.connected() as driver:
        await _zero(trial, driver)
        trial.device.fault("block_beam")
        # A stream shows a break only in the samples that fall into it.
        until_s = trial.device.state().time_s + _INTERRUPTION_S
        while trial.device.state().time_s < until_s:  # noqa: ASYNC110  # the bench gives its time only when asked
            await asyncio.sleep(0)
        trial.device.clear_faults()
        status = await _status_with(trial, driver, beam_ok=True)
        expect(status.beam_lost, f"the beam was interrupted for a moment, and status() is {status!r}")


async def a_new_link_counts_as_a_lost_beam(trial: Trial) -> None:
    """After the link was opened again nothing proves that the count went on: `beam_lost` until a zero."""
    async with trial.connected() as driver:
        await _zero(trial, driver)
        trial.drop()
        await trial.ask_after_trouble(driver)
        status = await trial.in_time(driver.status(), "status()")
        expect(
            status.beam_lost, f"the link was opened again, and status() is {status!r}: note it as a lost beam"
        )


async def a_zero_without_an_answer_spoils_no_count(trial: Trial) -> None:
    """When the answer to a zero is lost, the count is right for its number, or `beam_lost` until the next zero."""

    async def give_up(driver: Any) -> None:
        trial.mute()
        with contextlib.suppress(DeviceError):
            await _zero(trial, driver)

    await _examine_given_up_zero(trial, give_up)


async def a_cancelled_zero_spoils_no_count(trial: Trial) -> None:
    """When a zero is cancelled, the count is right for its number, or `beam_lost` until the next zero."""

    async def give_up(driver: Any) -> None:
        trial.stall()
        zeroing = asyncio.create_task(_zero(trial, driver))
        await asyncio.sleep(_IN_FLIGHT_S)
        zeroing.cancel()
        await asyncio.wait({zeroing})

    await _examine_given_up_zero(trial, give_up)


async def no_zero_without_a_beam(trial: Trial) -> None:
    """Without a beam `zero` is refused, or the count is still marked as lost after it."""
    async with trial.connected() as driver:
        trial.device.fault("block_beam")
        await _status_with(trial, driver, beam_ok=False)
        try:
            await _zero(trial, driver)
        except DeviceError:
            return
        trial.device.clear_faults()
        status = await _status_with(trial, driver, beam_ok=True)
        expect(status.beam_lost, f"a zero without a beam made the count valid: {status!r}")


async def _zero(trial: Trial, driver: Any) -> int:
    number: int = await trial.in_time(driver.zero(), "zero()")
    return number


async def _examine_given_up_zero(trial: Trial, give_up: Callable[[Any], Awaitable[None]]) -> None:
    """Give up a zero between two shifts of the reflector: the count goes on from the old zero, or from this one."""
    async with trial.connected() as driver, _reflector(trial) as shift:
        number = await _zero(trial, driver)
        before_mm = shift(_SHIFT_MM)
        # What a stream still has under way would make the zero one of before the shift.
        await _expect_mm(trial, driver, before_mm, "after the reflector moved away")
        await give_up(driver)
        after_mm = shift(_SHIFT_MM)
        trial.release()
        await trial.ask_after_trouble(driver)
        for _ in range(_TRIES):
            reading = await trial.ask(driver)
            status = await trial.in_time(driver.status(), "status()")
            right_mm = after_mm + (before_mm if reading.zero_id == number else 0.0)
            if status.beam_lost or abs(reading.displacement_mm - right_mm) < _SAME_MM:
                return
    expect(
        False,
        f"a zero was given up, and the count passes for valid with {reading!r}, {right_mm:.4f} mm are right: note "
        "it as a lost beam, and never zero again when nobody asks for it",
    )


@asynccontextmanager
async def _reflector(trial: Trial) -> AsyncIterator[Callable[[float], float]]:
    """Yield what moves the reflector along the beam and returns by how much that has grown; it is put back."""
    beam = trial.device.state().beam
    way_rad = math.radians(beam.direction_deg)

    def shift(along_mm: float) -> float:
        length_mm = trial.device.state().beam.length_mm
        way = {"dx_mm": along_mm * math.cos(way_rad), "dy_mm": along_mm * math.sin(way_rad)}
        trial.device.fault("move_reflector", reflector=beam.nearest, **way)
        return trial.device.state().beam.length_mm - length_mm

    try:
        yield shift
    finally:
        shift(beam.length_mm - trial.device.state().beam.length_mm)


async def _expect_mm(trial: Trial, driver: Any, right_mm: float, when: str) -> None:
    """A stream may still carry an older value: the first few readings may."""
    reading = await trial.ask(driver)
    for _ in range(_TRIES):
        if abs(reading.displacement_mm - right_mm) < _SAME_MM:
            return
        reading = await trial.ask(driver)
    expect(False, f"{when} the displacement is {reading.displacement_mm} mm, {right_mm:.4f} mm are right")


async def _status_with(trial: Trial, driver: Any, *, beam_ok: bool) -> Any:
    """Ask until the state of the beam has reached the driver: a stream may still carry an older one."""
    status = await trial.in_time(driver.status(), "status()")
    for _ in range(_TRIES):
        if status.beam_ok == beam_ok:
            return status
        status = await trial.in_time(driver.status(), "status()")
    expect(False, f"the beam {'returns' if beam_ok else 'is interrupted'}, and status() stays at {status!r}")
    return status


CHECKS = (
    Check(it_says_who_corrects_for_the_air, _ROLES),
    Check(status_and_reading_agree, _ROLES),
    Check(zeros_are_numbered, _ROLES),
    Check(zeros_are_numbered_on_over_a_new_link, _ROLES),
    Check(a_zero_makes_the_count_zero, _ROLES, ("bench",)),
    Check(the_displacement_grows_with_the_beam, _ROLES, ("bench",)),
    Check(a_late_answer_belongs_to_no_question, _ROLES, ("bench", "proxy")),
    Check(a_lost_beam_is_latched_until_the_next_zero, _ROLES, ("bench",)),
    Check(a_beam_lost_between_two_questions_is_seen, _ROLES, ("bench",)),
    Check(a_new_link_counts_as_a_lost_beam, _ROLES, ("proxy",)),
    Check(a_zero_without_an_answer_spoils_no_count, _ROLES, ("bench", "proxy")),
    Check(a_cancelled_zero_spoils_no_count, _ROLES, ("bench", "proxy")),
    Check(no_zero_without_a_beam, _ROLES, ("bench",)),
)
