"""A real arm drives only where it was walked, unless somebody has said in writing why not."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from typing import Final, Protocol

from catseye.app.engine.questions import WALK_WAIVER
from catseye.app.engine.walked.register import as_row
from catseye.app.engine.walked.tube import TUBE_DEG, TUBE_MM, Leg, Tubes, legs_through, uncovered
from catseye.app.errors import PromptUnansweredError, UnwalkedError
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.pose import Axes, Pose, pose_text
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.records import Json

WAIVER: Final = "walk_waiver"
"""What a run calls it in its record."""

_LISTED: Final = 20
"""Motions that a record lists; all of them are counted."""

_REMEDY: Final = "walk the plan first (catseye run PROCEDURE --walk), or give a reason with --waive-walk"


class Desk(Protocol):
    """Asks and keeps."""

    async def ask(self, prompt: Prompt) -> str:
        """Put a question to the operator."""
        ...

    async def event(self, kind: str, **data: Json) -> None:
        """Store and publish something that happened."""
        ...


class WalkRule:
    """Knows which motions of one run were walked; in force on a real arm, from `begin` on, until it is waived.

    Args:
        motions_from: returns every motion that the run would drive from where the arm stands.
        walked: returns the motions of valid walks of an arm.
        blended: the arm passes the targets of a way without standing still.
        reason: why motions may be driven that were not walked, as typed beforehand; None when nothing was typed.
    """

    def __init__(
        self,
        axes: Axes,
        motions_from: Callable[[Pose], Awaitable[Sequence[Leg]]],
        walked: Callable[[Identity], Sequence[Leg]],
        blended: bool,
        reason: str | None = None,
    ) -> None:
        self._axes = axes
        self._motions_from = motions_from
        self._walked = walked
        self._blended = blended
        self._reason = (reason or "").strip()
        self._tubes: Tubes | None = None

    @property
    def in_force(self) -> bool:
        """Motions are refused that were not walked."""
        return self._tubes is not None

    async def begin(self, arm: Identity, here: Pose, desk: Desk, store: RunStore) -> None:
        """Look at the whole plan before anything moves.

        Raises:
            UnwalkedError: motions were not walked and nobody waives that.
        """
        if WAIVER in RunReader(store.path).meta:
            return
        motions = await self._motions_from(here)
        walked = await asyncio.to_thread(self._walked, arm)
        self._tubes = Tubes(self._axes, walked)
        left = await asyncio.to_thread(uncovered, self._axes, motions, walked)
        await desk.event(
            "walked-motions",
            of=len(motions),
            unwalked=len(left),
            first=[as_row(leg) for leg in left[:_LISTED]],
        )
        if left:
            counted = f"{len(left)} of {len(motions)} motions of this run were not walked"
            await self.waive(f"{counted}, the first {self._leg_text(left[0])}", desk, store)

    def require(self, start: Pose, way: Sequence[Pose]) -> None:
        """Check a motion through targets.

        Raises:
            UnwalkedError: it leaves every tube.
        """
        if self._tubes is None:
            return
        for leg in legs_through(start, way, blended=self._blended):
            if not self._tubes.covers(leg):
                raise UnwalkedError(
                    f"the motion {self._leg_text(leg)} was not walked: it leaves {TUBE_DEG:g}° and {TUBE_MM:g} mm "
                    "around every motion that was"
                )

    async def waive(self, missing: str, desk: Desk, store: RunStore) -> None:
        """Have somebody say why the rest of the run may be driven all the same; the run keeps it.

        Raises:
            UnwalkedError: nobody waives it.
        """
        reason = self._reason or await _asked(missing, desk)
        if reason.lower() in {"", "no"}:
            raise UnwalkedError(f"{missing}: nothing more is driven; {_REMEDY}")
        await store.append_meta({WAIVER: {"reason": reason, "missing": missing}})
        await desk.event("walk-waived", reason=reason, missing=missing)
        self._tubes = None

    def _leg_text(self, leg: Leg) -> str:
        return f"from {pose_text(self._axes, leg.start)} to {pose_text(self._axes, leg.end)}"


async def _asked(missing: str, desk: Desk) -> str:
    prompt = WALK_WAIVER.prompt(
        WALK_WAIVER.id,
        f"{missing}. Type why they may be driven at full speed all the same (the run keeps it), or no.",
    )
    try:
        return (await desk.ask(prompt)).strip()
    except PromptUnansweredError as error:
        raise UnwalkedError(f"{missing}: nothing was moved; {_REMEDY}") from error
