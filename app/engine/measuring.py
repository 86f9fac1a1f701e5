"""Measuring one distance at standstill."""

import statistics
from collections.abc import Callable, Coroutine
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from catseye.app.cell.model import Air
from catseye.app.engine.apart import apart
from catseye.app.engine.compensation import Compensation
from catseye.app.engine.devices import Devices
from catseye.app.engine.waiting import together
from catseye.drivers.roles.air import AirSample, AirSensor
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import RefusedError
from catseye.drivers.roles.interferometer import BeamStatus, Interferometer, LengthReading
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import Robot
from catseye.procedures.kit.context import AirCorrection, Measurement
from catseye.procedures.kit.errors import NoBeamError

T = TypeVar("T")


class AirCache:
    """The state of the air, sampled anew when the last sample is older than a limit.

    Args:
        max_age_s: how old a sample may be, s of the clock.
    """

    def __init__(self, sensor: AirSensor, clock: Clock, max_age_s: float) -> None:
        self._sensor = sensor
        self._clock = clock
        self._max_age_s = max_age_s
        self._sample: AirSample | None = None
        self._time_s = 0.0

    async def get(self) -> AirSample:
        """Return a sample that is young enough."""
        if self._sample is None or self._clock.monotonic_s() - self._time_s > self._max_age_s:
            self._sample = await self._sensor.sample()
            self._time_s = self._clock.monotonic_s()
        return self._sample


@dataclass(frozen=True)
class Lengths:
    """What a distance is measured with.

    Attributes:
        counter: the interferometer.
        air: state of the air.
        compensation: corrects for the air what the instrument does not.
    """

    counter: Interferometer
    air: AirCache
    compensation: Compensation


def lengths_of(devices: Devices, clock: Clock, rule: Air) -> Lengths | None:
    """Return what distances are measured with; None where a device for it is missing."""
    counter, air = devices.interferometer, devices.environment
    if counter is None or air is None:
        return None
    return Lengths(counter, AirCache(air, clock, rule.max_age_s), Compensation(counter.compensated, rule))


def dwell_interval_s(dwell_time_s: float, readings: int) -> float:
    """Return the time between two readings spread over a dwell, s; a single reading waits for nothing."""
    return dwell_time_s / (readings - 1) if readings > 1 else 0.0


async def unless_dark(counter: Interferometer, question: Coroutine[Any, Any, T]) -> T:
    """Ask a length counter for a zero or a reading; distinguish a refusal for want of a beam from any other.

    Raises:
        NoBeamError: it refuses, and its beam is or was away.
    """
    try:
        return await question
    except RefusedError as error:
        status = await counter.status()
        if not status.interrupted:
            raise
        raise NoBeamError(str(error)) from error


async def measure(
    robot: Robot,
    lengths: Lengths,
    clock: Clock,
    dwell_time_s: float,
    readings: int,
    waited: Callable[[float], None],
) -> Measurement:
    """Average readings spread over a dwell; joints and air are read meanwhile, the beam afterwards.

    The beam comes last since its latches show whether it was there during all readings. Readings that stand apart
    from the others are left out.

    Args:
        dwell_time_s: from the first to the last reading, s.
        readings: how many, at least 1.
        waited: called with how long the dwell took, s of the clock.

    Raises:
        MeasurementRejectedError: the program has to correct for the air and does not know it.
        NoBeamError: the instrument gives no value without a beam.
    """
    if readings < 1:
        raise ValueError(f"readings = {readings}; a measurement needs at least 1")
    time_utc, clock_s = clock.now_utc().isoformat(), clock.monotonic_s()
    taken: list[LengthReading] = []
    reported: list[Pose] = []
    samples: list[AirSample] = []

    async def read() -> None:
        start_s = clock.monotonic_s()
        for number in range(readings):
            due_s = start_s + number * dwell_interval_s(dwell_time_s, readings)
            if (wait_s := due_s - clock.monotonic_s()) > 0:
                await clock.sleep(wait_s)
            if number == readings - 1:
                waited(clock.monotonic_s() - start_s)
            taken.append(await unless_dark(lengths.counter, lengths.counter.read()))

    async def look() -> None:
        reported.append(await robot.joints())

    async def sample() -> None:
        samples.append(await lengths.air.get())

    await together(read(), look(), sample())
    beam = await lengths.counter.status()
    averaged = _average(taken, beam, reported[0], samples[0], time_utc, lengths.compensation)
    return replace(averaged, clock_s=clock_s)


def _average(
    taken: list[LengthReading],
    beam: BeamStatus,
    reported: Pose,
    air: AirSample,
    time_utc: str,
    compensation: Compensation,
) -> Measurement:
    strays = apart([reading.displacement_mm for reading in taken])
    values = [reading.displacement_mm for at, reading in enumerate(taken) if at not in strays]
    raw_mm = statistics.fmean(values)
    corrected = compensation.correct(raw_mm, air)
    zero = corrected.zero
    return Measurement(
        displacement_mm=corrected.displacement_mm,
        spread_mm=statistics.stdev(values) if len(values) > 1 else 0.0,
        readings=len(values),
        beam=beam,
        reported=reported,
        air=air,
        time_utc=time_utc,
        duration_s=taken[-1].time_s - taken[0].time_s,
        correction=AirCorrection(
            raw_displacement_mm=raw_mm,
            refractive_index=corrected.index,
            zero_refractive_index=None if zero is None else zero.index,
            dead_path_mm=None if zero is None else zero.dead_path_mm,
            formula=corrected.formula,
        ),
        apart=tuple(taken[at].raw for at in strays),
    )
