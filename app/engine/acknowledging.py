"""After the surroundings have stopped the robot: asking somebody whether it may move again."""

from collections.abc import Awaitable, Callable

from catseye.app.engine.control import RunControl
from catseye.app.engine.gate import MotionGate
from catseye.app.engine.questions import ACKNOWLEDGE
from catseye.app.errors import InterruptionError, NotAcknowledgedError, PromptUnansweredError, SafetyError
from catseye.app.guard.client import ArmGuard
from catseye.drivers.roles.clock import Clock
from catseye.procedures.kit.context import Prompt

_RESUME = "the robot is at rest and the run has ended; when all is well, continue with catseye resume"


class Acknowledging:
    """Asks until a person has said yes to all that has stopped the robot, and the door is closed.

    Args:
        guard: of the arm, which has to know too; None where there is none.
        poll_s: between two looks at a door that is still open, s of the clock.
        ask: puts a question to the operator, whatever state the run is in.
    """

    def __init__(
        self,
        control: RunControl,
        gate: MotionGate,
        guard: ArmGuard | None,
        clock: Clock,
        poll_s: float,
        ask: Callable[[Prompt], Awaitable[str]],
        warn: Callable[[str], Awaitable[None]],
    ) -> None:
        self._control = control
        self._gate = gate
        self._guard = guard
        self._clock = clock
        self._poll_s = poll_s
        self._ask = ask
        self._warn = warn
        self._asked = 0

    async def __call__(self) -> None:
        """Ask whether to go on, and permit motion when it is so.

        Raises:
            NotAcknowledgedError: nobody is there, or the answer is no.
            SafetyError: the override does not come down to the cap.
        """
        while True:
            asked_after = self._control.interruptions
            await self._asked_once(self._control.interruption)
            try:
                self._gate.require_door()
            except InterruptionError as error:
                await self._warn(f"not yet: {error}")
                await self._until_closed()
                continue
            await self._lower_override()
            if self._taken(asked_after):
                return

    def _taken(self, asked_after: int) -> bool:
        """Permit motion if nothing has happened since the question; return whether it is so.

        Whoever opened the door meanwhile, and closed it behind them, is in the cell: the answer was given before.
        """
        if self._control.interruptions != asked_after:
            return False
        self._control.acknowledge("the operator has acknowledged the interruption")
        if self._guard is not None and not self._control.unacknowledged:
            self._guard.acknowledge()
        return True

    async def _asked_once(self, reason: str) -> None:
        self._asked += 1
        prompt = ACKNOWLEDGE.prompt(
            f"acknowledge/{self._asked}",
            f"The robot was stopped: {reason}. Is the arm's way clear and everything in its place? The arm "
            "then continues.",
            # The program has failed here, on emulated devices as on real ones: it does not forgive itself.
            by_person=self._guard is not None and bool(self._guard.stopped),
        )
        try:
            answer = await self._ask(prompt)
        except PromptUnansweredError as error:
            raise NotAcknowledgedError(f"{reason}; nobody was there to acknowledge it: {_RESUME}") from error
        if answer != "yes":
            raise NotAcknowledgedError(f"{reason}; the operator did not let it go on: {_RESUME}")

    async def _lower_override(self) -> None:
        try:
            await self._gate.lower_override()
        except InterruptionError as error:
            # Acknowledged or not: a controller that keeps its override up is not to be moved.
            raise SafetyError(str(error)) from error

    async def _until_closed(self) -> None:
        while True:
            self._control.raise_ending()
            try:
                self._gate.require_door()
            except InterruptionError:
                await self._clock.sleep(self._poll_s)
            else:
                return
