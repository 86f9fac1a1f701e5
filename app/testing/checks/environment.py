"""What a measurement relies on in an air sensor's driver."""

import contextlib
import math
from typing import Any

from catseye.app.testing.checks.check import Check
from catseye.app.testing.trial import Trial, expect
from catseye.drivers.roles.device import Role
from catseye.drivers.roles.errors import DeviceError

_ROLES: tuple[Role, ...] = ("environment",)
_QUANTITIES = ("temperature_c", "pressure_hpa", "humidity_percent")
_WARMER_K = 5.0


async def samples_are_numbers_or_none(trial: Trial) -> None:
    """A quantity is a finite number, or None when the sensor does not give it; never NaN."""
    async with trial.connected() as driver:
        _check_values(await trial.ask(driver))


async def a_missing_value_is_none(trial: Trial) -> None:
    """A sensor that has no value for the moment gives None or an error; never NaN, never the last value."""
    async with trial.connected() as driver:
        before = await trial.ask(driver)
        trial.device.fault("air", nan=True)
        try:
            sample = await trial.ask(driver)
        except DeviceError:
            return
        _check_values(sample)
        kept = [
            name
            for name in _QUANTITIES
            if getattr(before, name) is not None and getattr(sample, name) is not None
        ]
        expect(not kept, f"the sensor has no values, and {', '.join(kept)} still have one: {sample!r}")


async def samples_are_of_now(trial: Trial) -> None:
    """A sample follows the air, in the units of the house."""
    async with trial.connected() as driver:
        before = await trial.ask(driver)
        if before.temperature_c is not None:
            expect(15.0 < before.temperature_c < 25.0, f"the air has 20 °C, and the sample says {before!r}")
        if before.pressure_hpa is not None:
            expect(
                1000.0 < before.pressure_hpa < 1030.0, f"the air has 1013 hPa, and the sample says {before!r}"
            )
        trial.device.fault("air", temperature_k=_WARMER_K)
        _check_warmer(before, await trial.ask(driver))


async def a_late_answer_belongs_to_no_question(trial: Trial) -> None:
    """After a stall the next sample is of now, not the late answer to an older question."""
    async with trial.connected() as driver:
        before = await trial.ask(driver)
        trial.stall()
        with contextlib.suppress(DeviceError):
            await trial.ask(driver)
        trial.device.fault("air", temperature_k=_WARMER_K)
        trial.release()
        _check_warmer(before, await trial.ask_after_trouble(driver))


def _check_values(sample: Any) -> None:
    for name in _QUANTITIES:
        value = getattr(sample, name)
        expect(value is None or math.isfinite(value), f"{name} is {value!r}: what is missing is None")


def _check_warmer(before: Any, after: Any) -> None:
    if before.temperature_c is None:
        return
    grown_k = after.temperature_c - before.temperature_c
    expect(abs(grown_k - _WARMER_K) < 0.5, f"the air is {_WARMER_K:g} K warmer, the sample {grown_k:.2f} K")


CHECKS = (
    Check(samples_are_numbers_or_none, _ROLES),
    Check(a_missing_value_is_none, _ROLES, ("bench",)),
    Check(samples_are_of_now, _ROLES, ("bench",)),
    Check(a_late_answer_belongs_to_no_question, _ROLES, ("bench", "proxy")),
)
