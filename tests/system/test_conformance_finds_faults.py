"""The conformance suite finds what it looks for: drivers with one fault each fail the check that is about it."""

import asyncio
import time
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import pytest
from pydantic import BaseModel, ConfigDict

from catseye.app.testing.candidate import candidate_of
from catseye.app.testing.checks.catalogue import ALL, applicable
from catseye.app.testing.checks.check import Check, run_check
from catseye.app.testing.trial import NotConformingError
from catseye.drivers.air.modbus_air import ModbusAir
from catseye.drivers.air.ptu300 import VaisalaAscii
from catseye.drivers.counter.counter import LineCounter
from catseye.drivers.links.latches import Latches
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.roles.air import AirSample
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import DeviceError, LinkTimeoutError
from catseye.drivers.roles.interferometer import BeamStatus, LengthReading
from catseye.drivers.roles.pose import Pose
from tests.system.quick import TIMEOUT_S, short_timeouts


class Lax(LineCounter):
    """Has settings that take anything, and an argument without unit."""

    class Settings(BaseModel):  # that is the fault
        """Nothing is reported."""

        model_config = ConfigDict(extra="ignore")

        patience: float = 1.0

    def wait(self, length: float) -> None:
        """Wait a length."""


class Forgetful(LineCounter):
    """Takes a returning beam for a valid one."""

    async def status(self) -> BeamStatus:
        """Return what the instrument shows."""
        status = await super().status()
        return replace(status, beam_lost=not status.beam_ok)


class SameZero(LineCounter):
    """Numbers no zeros."""

    async def zero(self) -> int:
        """Zero."""
        await super().zero()
        return 1


class Remembering(LineCounter):
    """Answers from memory when the instrument is silent."""

    last: LengthReading | None = None

    async def read(self) -> LengthReading:
        """Return the last reading if there is no new one."""
        try:
            self.last = await super().read()
        except DeviceError:
            if self.last is None:
                raise
        return self.last


class Trusting(LineCounter):
    """Takes the next line for its answer, whoever asked for it."""

    async def read(self) -> LengthReading:
        """Ask and take a line."""
        transport, line = self._link._transport, b""  # noqa: SLF001  # past the link, that is the fault
        try:
            async with asyncio.timeout(TIMEOUT_S):
                await transport.write(b"R\r\n")
                while not line.endswith(b"\n"):
                    line += await transport.read()
        except TimeoutError:
            raise LinkTimeoutError(f"{self._link.where}: no line: check the link") from None
        return LengthReading(float(line.split()[0]), line.decode("ascii"), self._clock.monotonic_s())


class Deserting(Trusting):
    """Heals the link after a time-out, but not after a cancellation."""

    is_late = False

    async def read(self) -> LengthReading:
        """Ask and take a line."""
        if self.is_late:
            self._link.distrust("no line came")
            await self._link.ensure()
        self.is_late = False
        try:
            return await super().read()
        except LinkTimeoutError:
            self.is_late = True
            raise


class Hasty(LineCounter):
    """Trusts the old count although it is unknown whether the instrument has zeroed."""

    async def _zero(self, command: str, reply: str) -> None:
        del reply
        await self._ask(command)


class Rezeroing(LineCounter):
    """Zeroes again by itself, later, when the answer to a zero was lost."""

    owed = False

    async def zero(self) -> int:
        """Zero."""
        self.owed = True
        number = await super().zero()
        self.owed = False
        return number

    async def read(self) -> LengthReading:
        """Catch up on a zero, and read."""
        if self.owed:
            await self.zero()
        return await super().read()


class Renumbering(LineCounter):
    """Numbers zeros from 1 again after each connection."""

    async def connect(self) -> Identity:
        """Connect."""
        self._latches.zero_id = 0
        return await super().connect()


class Pretending(LineCounter):
    """Says of every instrument that it is emulated."""

    async def connect(self) -> Identity:
        """Connect."""
        return replace(await super().connect(), simulated=True)


class Blocking(LineCounter):
    """Waits without letting others work."""

    async def read(self) -> LengthReading:
        """Wait and read."""
        time.sleep(0.7)  # noqa: ASYNC251  # that is the fault
        return await super().read()


class Swallowing(LineCounter):
    """Turns every error into one of its own."""

    async def connect(self) -> Identity:
        """Connect."""
        try:
            return await super().connect()
        except DeviceError as error:
            raise OSError(str(error)) from error


class Terse(LineCounter):
    """Says too little."""

    async def read(self) -> LengthReading:
        """Return a reading."""
        try:
            return await super().read()
        except LinkTimeoutError:
            raise DeviceError("failed") from None


class Leaving(LineCounter):
    """Leaves a task behind."""

    pending: ClassVar[set["asyncio.Task[None]"]] = set()

    async def connect(self) -> Identity:
        """Connect and start something."""
        self.pending.add(asyncio.get_running_loop().create_task(asyncio.sleep(60.0)))
        return await super().connect()


class Stubborn(LineCounter):
    """Does not let itself be cancelled."""

    async def read(self) -> LengthReading:
        """Return a reading, whatever happens."""
        try:
            return await super().read()
        except asyncio.CancelledError:
            return await super().read()


class Reviving(LineCounter):
    """Trusts a count over a new link."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._latches = _NeverGreeted()


class _NeverGreeted(Latches):
    def greeting(self) -> None:
        """Forget."""


class NaNAir(ModbusAir):
    """Gives NaN for what is missing."""

    async def sample(self) -> AirSample:
        """Return a sample."""
        sample = await super().sample()
        return sample if sample.temperature_c is not None else replace(sample, temperature_c=float("nan"))


class Unsuspecting(VaisalaAscii):
    """Does not look whether the same sensor answers as before."""

    async def _greet(self) -> None:
        self._serial = ""
        await super()._greet()


class Repeating(MelfaR3):
    """Commands a motion again when its answer is lost."""

    async def account_for(self, target: Pose, lost: DeviceError) -> None:
        """Stop and move again."""
        del lost
        await self.stop()
        await self.move_joints(target)


class Coasting(MelfaR3):
    """Does not stop."""

    async def stop(self) -> None:
        """Let it run out."""


FAULTS: list[tuple[str, type, str]] = [
    ("line-counter", Lax, "settings_are_a_strict_closed_model"),
    ("line-counter", Lax, "settings_are_described_with_units"),
    ("line-counter", Lax, "arguments_carry_units"),
    ("line-counter", Forgetful, "a_lost_beam_is_latched_until_the_next_zero"),
    ("line-counter", Forgetful, "a_beam_lost_between_two_questions_is_seen"),
    ("line-counter", Reviving, "a_new_link_counts_as_a_lost_beam"),
    ("line-counter", SameZero, "zeros_are_numbered"),
    ("line-counter", Remembering, "a_stalled_device_times_out_and_is_healed"),
    ("line-counter", Trusting, "a_late_answer_answers_no_later_question"),
    ("line-counter", Terse, "a_stalled_device_times_out_and_is_healed"),
    ("line-counter", Swallowing, "a_dead_endpoint_is_a_link_error"),
    ("line-counter", Swallowing, "a_stranger_is_a_device_error"),
    ("line-counter", Blocking, "the_loop_is_never_blocked"),
    ("line-counter", Leaving, "nothing_is_left_after_close"),
    ("line-counter", Stubborn, "a_cancelled_question_leaves_the_link_usable"),
    ("line-counter", Deserting, "a_cancelled_question_answers_no_later_one"),
    ("line-counter", Hasty, "a_cancelled_zero_spoils_no_count"),
    ("line-counter", Rezeroing, "a_zero_without_an_answer_spoils_no_count"),
    ("line-counter", Rezeroing, "a_cancelled_zero_spoils_no_count"),
    ("line-counter", Renumbering, "zeros_are_numbered_on_over_a_new_link"),
    ("line-counter", Pretending, "simulated_is_said_by_the_device"),
    ("modbus-air", NaNAir, "a_missing_value_is_none"),
    ("vaisala-ascii", Unsuspecting, "another_serial_number_is_noticed"),
    ("melfa-r3", Repeating, "a_lost_answer_never_repeats_a_motion"),
    ("melfa-r3", Coasting, "stop_ends_a_motion"),
]


@pytest.mark.parametrize(("name", "driver", "check"), FAULTS, ids=[f"{d.__name__}-{c}" for _, d, c in FAULTS])
def test_a_fault_is_found(name: str, driver: type, check: str, tmp_path: Path) -> None:
    sound = candidate_of(name)
    faulty = replace(sound, driver=driver, settings=short_timeouts(sound, tmp_path))
    (wanted,) = [one for one in applicable(sound) if one.name == check]
    with pytest.raises(NotConformingError):
        run_check(wanted, faulty)


def test_a_cancelled_question_needs_a_check_of_its_own(tmp_path: Path) -> None:
    deserting = replace(
        candidate_of("line-counter"),
        driver=Deserting,
        settings=short_timeouts(candidate_of("line-counter"), tmp_path),
    )
    run_check(check_named("a_late_answer_answers_no_later_question"), deserting)


STREAMING = b"B5\r\n"
"""Has the emulated counter send a value every 5 ms."""


def test_a_counter_left_streaming_needs_a_first_command(tmp_path: Path) -> None:
    sound = candidate_of("line-counter", streaming=STREAMING)
    settings = short_timeouts(sound, tmp_path)
    check = check_named("a_device_left_streaming_is_connected")
    with pytest.raises(NotConformingError, match="first command"):
        run_check(check, replace(sound, settings=settings))
    profile = Path(settings["profile"])
    profile.write_text(
        profile.read_text(encoding="utf-8").replace("[start]", '[start]\nfirst = "H"'), encoding="utf-8"
    )
    run_check(check, replace(sound, settings=settings))


def check_named(name: str) -> Check:
    return next(one for one in ALL if one.name == name)
