"""Why a job ends before its last stage, and how the stage under way hears of it."""

import asyncio
import signal
from dataclasses import dataclass
from typing import Final

from catseye.app.campaign.deadline import Deadline
from catseye.app.protocol.campaign_events import Code
from catseye.app.service.command_process import Signal
from catseye.drivers.roles.clock import Clock

_LOOK_S: Final = 5.0
"""How often the clock on the wall is looked at, which somebody may set meanwhile."""

_GRACE_S: Final = 60.0
"""How long a stage has to end, real s, before its process is killed; a guard of its own stops the arm then."""


@dataclass(frozen=True)
class Cause:
    """Why something ends before it is done.

    Attributes:
        code: for programs.
        text: for people.
    """

    code: Code
    text: str


class Ending:
    """Passes signals on to the stage under way, and remembers why the job ends.

    It is made when the job is called: durations count from then.

    Attributes:
        cause: why; None while it goes on.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._begun_s = clock.monotonic_s()
        self._signal: Signal | None = None
        self._terminating: asyncio.Task[None] | None = None
        self.cause: Cause | None = None

    def deliver(self, number: int) -> None:
        """Take a signal that the process was sent.

        Those of the stop ladder (Ctrl-C holds, then stops, then aborts) are the run's: how it ends decides about the
        job.
        """
        if number in {signal.SIGTERM, signal.SIGHUP}:
            self._end(Cause("terminated", "the job was terminated from outside"))
            self._begin_to_terminate()
            return
        if self._signal is None and number == signal.SIGINT:
            self._end(Cause("interrupted", "the job was interrupted"))
        if self._signal is not None:
            self._signal(number)

    def started(self, send: Signal) -> None:
        """A stage is under way; it is ended at once where the job ends already."""
        self._signal = send
        if self.cause is not None:
            self._begin_to_terminate()

    def over(self) -> None:
        """No stage is under way."""
        self._signal = None
        if self._terminating is not None:
            self._terminating.cancel()
            self._terminating = None

    def operator_ended(self) -> None:
        """The operator has ended the run under way."""
        self._end(Cause("interrupted", "the operator ended the run"))

    def left_s(self, deadline: Deadline) -> float:
        """Return how long it is to a deadline, real s; negative where it has passed."""
        if deadline.within_s is not None:
            return self._begun_s + deadline.within_s - self._clock.monotonic_s()
        return (deadline.time - self._clock.now_utc()).total_seconds()

    async def at(self, deadline: Deadline) -> None:
        """End the job when its deadline has come."""
        while (left_s := self.left_s(deadline)) > 0.0:
            await self._clock.sleep(min(left_s, _LOOK_S))
        self._end(Cause("deadline", f"the deadline {deadline.time:%Y-%m-%dT%H:%M:%SZ} has come"))
        await self.terminate()

    async def terminate(self) -> None:
        """End the stage under way; kill its process if it does not."""
        if (send := self._signal) is None:
            return
        send(signal.SIGTERM)
        await self._clock.sleep(_GRACE_S)
        if self._signal is send:
            send(signal.SIGKILL)

    async def wait(self, duration_s: float) -> Cause | None:
        """Wait, but no longer than the job goes on; return why it ends, None where it does not."""
        end_s = self._clock.monotonic_s() + duration_s
        while self.cause is None and (left_s := end_s - self._clock.monotonic_s()) > 0.0:
            await self._clock.sleep(min(left_s, 1.0))
        return self.cause

    def _begin_to_terminate(self) -> None:
        if self._signal is not None and self._terminating is None:
            self._terminating = asyncio.get_running_loop().create_task(self.terminate())

    def _end(self, cause: Cause) -> None:
        self.cause = self.cause or cause
