"""Whether the counter is read often enough for the evaluation, before a day is measured for nothing."""

from typing import Final

from catseye.calibration.resolution.sampling import LEAST_RATE_HZ, NEARLY
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import SlowCounterError
from catseye.procedures.kit.recording import Recording
from catseye.procedures.resolution.questions import SLOW_COUNTER

LOOK_AFTER_S: Final = 10.0
"""Of recording: a start that is late by half a second counts 5 % then."""


class ReadingRate:
    """Looks at the rate of recordings; says once that it is too low.

    Args:
        accept_slow: go on without a question.
    """

    def __init__(self, ctx: Context, *, accept_slow: bool) -> None:
        self._ctx = ctx
        self._accepted = accept_slow
        self._said = False

    async def require(self, recording: Recording, goal: Pose) -> None:
        """Look at the rate of a recording so far; where it is too low, have somebody decide.

        Args:
            recording: under way for some seconds.
            goal: where the arm stands that moves afterwards.

        Raises:
            SlowCounterError: the rate is too low, and nobody wants to go on.
        """
        rate_hz = recording.readings / recording.elapsed_s
        if self._said or rate_hz >= NEARLY * LEAST_RATE_HZ:
            return
        # Some counters give no value without a beam; the loss of the beam has ways of its own.
        if not (await self._ctx.beam()).count_valid:
            return
        self._said = True
        fault = (
            f"the counter gives {rate_hz:.1f} readings a second, and the evaluation needs {LEAST_RATE_HZ:g} "
            f"({NEARLY * LEAST_RATE_HZ:.1f} or more is accepted, since clocks differ): lower the --speed of "
            "an emulated bench, or use a counter that sends by itself (a faster link, a streaming driver)"
        )
        await self._ctx.warn(fault, rate_hz=rate_hz)
        if not self._accepted and await self._ctx.ask(_prompt(fault, goal)) == "stop":
            raise SlowCounterError(
                f"{fault}; then continue with catseye resume, or start again with --param accept_slow_counter=true"
            )


def _prompt(fault: str, goal: Pose) -> Prompt:
    return SLOW_COUNTER.prompt(
        "slow-counter",
        f"{fault[0].upper()}{fault[1:]}. End the run (stop), or step the arm and record anyway (anyway)?",
        target=goal,
    )
