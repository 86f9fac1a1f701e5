"""Why a job ends before its last stage, and how the stage under way hears of it."""

import signal
from dataclasses import dataclass
from datetime import datetime
from typing import Final

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

    Attributes:
        cause: why; None while it goes on.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._signal: Signal | None = None
        self.cause: Cause | None = None

    def deliver(self, number: int) -> None:
        """Take a signal that the process was sent.

        Those of the stop ladder (Ctrl-C holds, then stops, then aborts) are the run's: how it ends decides about the
        job.
        """
        if number in {signal.SIGTERM, signal.SIGHUP}:
            self._end(Cause("terminated", "the job was terminated from outside"))
        elif self._signal is None and number == signal.SIGINT:
            self._end(Cause("interrupted", "the job was interrupted"))
        if self._signal is not None:
            self._signal(number)

    def started(self, send: Signal) -> None:
        """A stage is under way; it is ended at once where the job ends already."""
        self._signal = send
        if self.cause is not None:
            send(signal.SIGTERM)

    def over(self) -> None:
        """No stage is under way."""
        self._signal = None

    def operator_ended(self) -> None:
        """The operator has ended the run under way."""
        self._end(Cause("interrupted", "the operator ended the run"))

    async def at(self, deadline: datetime) -> None:
        """End the job when its deadline has come."""
        while (left_s := (deadline - self._clock.now_utc()).total_seconds()) > 0.0:
            await self._clock.sleep(min(left_s, _LOOK_S))
        self._end(Cause("deadline", f"the deadline {deadline:%Y-%m-%dT%H:%M:%SZ} has come"))
        await self.terminate()

    async def terminate(self) -> None:
        """End the stage under way; kill its process if it does not."""
        if (send := self._signal) is None:
            return
        send(signal.SIGTERM)
        await self._clock.sleep(_GRACE_S)
        if self._signal is send:
            send(signal.SIGKILL)

    async def wait(self, duration_s: float) -> None:
        """Wait, but no longer than the job goes on."""
        end_s = self._clock.monotonic_s() + duration_s
        while self.cause is None and (left_s := end_s - self._clock.monotonic_s()) > 0.0:
            await self._clock.sleep(min(left_s, 1.0))

    def _end(self, cause: Cause) -> None:
        self.cause = self.cause or cause
