"""Whether a driver knows who answers: a real device or an emulator, and still the same one."""

import asyncio
from typing import Any

from catseye.app.testing.checks.check import Check
from catseye.app.testing.trial import NotApplicableError, NotConformingError, Trial, expect
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import DeviceError, WrongDeviceError

_PAUSE_S = 0.05
_QUESTIONS = 4
"""The first ones may still report that the link broke."""


async def simulated_is_said_by_the_device(trial: Trial) -> None:
    """`simulated` is True because the device says EMULATOR, so that a real one is never moved without `--arm`."""
    if not (await _identity(trial)).simulated:
        return
    trial.spoil(trial.candidate.unmarked)
    try:
        identity = await _identity(trial)
    except DeviceError as error:
        raise NotApplicableError(f"its answers cannot be changed on the way: {error}") from error
    expect(
        not identity.simulated,
        f"nothing that the device says is EMULATOR, and the identity is {identity!r}: read `simulated` from its "
        "answers, real arms move without --arm otherwise",
    )


async def another_serial_number_is_noticed(trial: Trial) -> None:
    """A device with another serial number behind a link that was opened again is a WrongDeviceError."""
    serial = (await _identity(trial)).serial
    if not serial:
        raise NotApplicableError("the device gives no serial number")

    def exchanged(data: bytes) -> bytes:
        return trial.candidate.exchanged(data, serial)

    trial.spoil(exchanged)
    if await _serial_or(serial, trial) == serial:
        raise NotApplicableError(f"its serial number {serial} cannot be changed on the way")
    trial.spoil(bytes)
    async with trial.connected() as driver:
        await trial.ask(driver)
        trial.spoil(exchanged)
        trial.drop()
        await asyncio.sleep(_PAUSE_S)
        await _expect_refusal(trial, driver)


async def _identity(trial: Trial) -> Identity:
    driver = trial.new_driver()
    try:
        identity: Identity = await trial.in_time(driver.connect(), "connect()")
    finally:
        await driver.close()
    return identity


async def _serial_or(default: str, trial: Trial) -> str:
    try:
        return (await _identity(trial)).serial
    except DeviceError:
        return default


async def _expect_refusal(trial: Trial, driver: Any) -> None:
    error: DeviceError | None = None
    for _ in range(_QUESTIONS):
        try:
            answer = await trial.ask(driver)
        except WrongDeviceError:
            return
        except DeviceError as other:
            error = other
        else:
            raise NotConformingError(
                f"a device with another serial number was asked, and {answer!r} taken: compare the identity each "
                "time that the link is opened"
            )
    raise NotConformingError(
        f"a device with another serial number answers with {error!r}: raise WrongDeviceError"
    )


CHECKS = (
    Check(simulated_is_said_by_the_device, needs=("proxy",)),
    Check(another_serial_number_is_noticed, needs=("proxy",)),
)
