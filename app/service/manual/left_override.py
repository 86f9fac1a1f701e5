"""The speed override that a jog or a walk has left, and how an operator has the one before set again."""

from catseye.app.engine.gate import WHOLE_PERCENT
from catseye.app.errors import CatseyeError, SafetyError
from catseye.app.protocol.answers import Answer
from catseye.app.protocol.engine_events import LeftOverride, OverrideLeft
from catseye.app.protocol.requests import RestoreOverride
from catseye.app.service.errors import RefusedError, refusal_of
from catseye.app.service.manual.device_loan import ManualBench
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.robot import Robot


def lowered(
    before_percent: float, left_percent: float, cap_percent: float, asked_percent: float
) -> LeftOverride | None:
    """Return what a jog or a walk has left; None where it lowered nothing, or a stop or somebody at the pendant did.

    Args:
        before_percent: that stood there before it.
        left_percent: that stands there after it.
        cap_percent: that the cell allows.
        asked_percent: that it has asked the controller for last, which may have rounded it down.
    """
    before = min(before_percent, cap_percent)
    as_asked = asked_percent - WHOLE_PERCENT < left_percent < asked_percent + 0.5 * WHOLE_PERCENT
    lowered = as_asked and 1.0 <= left_percent <= before - WHOLE_PERCENT
    return LeftOverride(before_percent=before, left_percent=left_percent) if lowered else None


class LeftOverrides:
    """Remembers what jogs and walks have left, over several of them as long as nobody else changes the override.

    Args:
        bench: its robot, and who hears of it.

    Attributes:
        left: what may be set again; None for nothing.
    """

    def __init__(self, bench: ManualBench) -> None:
        self.left: LeftOverride | None = None
        self._bench = bench

    def take(self, left: LeftOverride | None) -> None:
        """Take what a jog or a walk has left; None where it has left the override as it was."""
        if left is None:
            return
        earlier = self.left
        if earlier is not None and same(left.before_percent, earlier.left_percent):
            left = LeftOverride(before_percent=earlier.before_percent, left_percent=left.left_percent)
        self._set(left, "")

    async def restore(self, request: RestoreOverride, who: str) -> Answer:
        """Set the override again that stood before, and read it back.

        Raises:
            RefusedError: nothing was left, somebody has changed the override or the cell's cap since, or something
                moves: it stays.
        """
        left = self.left
        if left is None or not same(request.percent, left.before_percent):
            raise RefusedError(
                "that override did not stand before a jog or a walk, or is set again: look once more"
            )
        try:
            await self._require_allowed(left)
            async with (
                self._bench.pool.acquired_robot("robot") as robot,
                self._bench.owned("its override is set"),
            ):
                await self._restore(robot, left)
        except (CatseyeError, DeviceError) as error:
            raise refusal_of(error) from error
        self._set(None, f"{who} has set the speed override to {left.before_percent:g} % again")
        return Answer()

    async def _require_allowed(self, left: LeftOverride) -> None:
        cap_percent = (await self._bench.facts()).override_cap_percent
        if left.before_percent > cap_percent:
            text = f"the cell allows {cap_percent:g} % by now, not {left.before_percent:g} %: look once more"
            self._set(lowered(cap_percent, left.left_percent, cap_percent, left.left_percent), text)
            raise SafetyError(text)

    async def _restore(self, robot: Robot, left: LeftOverride) -> None:
        status = await robot.status()
        if status.running:
            raise SafetyError("the arm moves, or a program runs: the override stays; stop that first")
        now_percent = status.override_percent
        if not same(now_percent, left.left_percent):
            text = (
                f"the override reads {now_percent:g} % and the jog or walk has left {left.left_percent:g} %: "
                "somebody has changed it since, and it stays"
            )
            self._set(None, text)
            raise SafetyError(text)
        read_percent = await robot.set_override(left.before_percent)
        if not read_percent <= left.before_percent + 0.5 * WHOLE_PERCENT:
            await robot.set_override(left.left_percent)
            raise SafetyError(
                f"the controller was asked for {left.before_percent:g} % and reads {read_percent:g} %: it was asked "
                f"for {left.left_percent:g} % again"
            )

    def _set(self, left: LeftOverride | None, reason: str) -> None:
        self.left = left
        self._bench.announce(OverrideLeft(left=left, reason=reason))


def same(one_percent: float, other_percent: float) -> bool:
    """Return whether two overrides are the same but for what a controller rounds."""
    return abs(one_percent - other_percent) < 0.5 * WHOLE_PERCENT
