"""The artefact brought onto the axis of a joint: read, say how far it is off, have it tapped, read again."""

import math
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from catseye.calibration.standards.error_motion import eccentricity_of
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import AlignmentError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of
from catseye.procedures.kit.tasks import TapArtefact
from catseye.procedures.scara.questions import TAP
from catseye.procedures.scara.radial.radial_plan import Reading

_PLACES: Final = 5
"""Where the artefact is read to see how far it is off: three determine a circle."""

MOST_ROUNDS: Final = 8

Read = Callable[[str, float], Awaitable[float]]
"""Goes to an angle of the joint and returns what indicator x reads there; the text is part of the question's id."""

Go = Callable[[Pose], Awaitable[None]]


@dataclass(frozen=True)
class Centring:
    """Centres the artefact of one mounting.

    Attributes:
        reading: whose sweep and mounting.
        within_um: largest accepted eccentricity.
        read: at an angle.
        go: to a pose.
        is_fresh: the artefact was read by this process.
    """

    ctx: Context
    reading: Reading
    within_um: float
    read: Read
    go: Go
    is_fresh: Callable[[], bool]

    async def centre(self) -> None:
        """Go on until the eccentricity is small enough.

        Raises:
            AlignmentError: it did not become small enough, or the operator will not tap the artefact.
        """
        name = self.reading.mounting
        for number in range(1, MOST_ROUNDS + 1):
            title = f"{self.reading.sweep.joint}: is the artefact centred? round {number}"
            row = await self.ctx.step(f"{name}/centre/{number}", title, partial(self._measured, number))
            size_um = number_of(row, "size_um")
            good = size_um <= self.within_um
            text = "" if good else "tap the artefact onto the axis"
            self.ctx.show(Live("eccentricity", size_um, "µm", None, self.within_um, text))
            if good:
                return
            if number < MOST_ROUNDS:
                title = f"{self.reading.sweep.joint}: artefact tapped, round {number}"
                await self.ctx.step(f"{name}/tap/{number}", title, partial(self._tapped, number, row))
        raise AlignmentError(
            f"{self.reading.sweep.joint}: the artefact runs {size_um:.0f} µm off the axis after {MOST_ROUNDS} "
            f"rounds, accepted are {self.within_um:g} µm: see that its holder yields to a tap and holds afterwards, "
            "or raise centre_within_um"
        )

    async def _measured(self, number: int) -> Row:
        values = self.reading.sweep.values_deg
        places = np.unique(np.linspace(0, len(values) - 1, _PLACES).round().astype(int)).tolist()
        angles = [values[place] for place in places]
        name = f"{self.reading.mounting}/centre/{number}"
        read = [await self.read(f"{name}/{count}", angle) for count, angle in enumerate(angles, 1)]
        # The side on which the indicator stands.
        side_rad = math.pi if self.reading.turned else 0.0
        found = eccentricity_of(np.deg2rad(angles), np.full(len(angles), side_rad), np.array(read))
        return {
            "size_um": found.size_um,
            "nearest_deg": math.degrees(found.nearest_rad + side_rad),
            "mean_um": found.mean_um[0],
        }

    async def _tapped(self, number: int, row: Row) -> Row:
        """Turn the joint to where the indicator points along the eccentricity, and have the artefact tapped there."""
        if self.ctx.resumed and not self.is_fresh():
            await self.ctx.warn(
                "the run was interrupted while the artefact was to be tapped: its run-out is read again first"
            )
            return {"by_um": None}
        sweep, nearest_deg = self.reading.sweep, number_of(row, "nearest_deg")
        angles = np.array(sweep.values_deg)
        facing = np.cos(np.deg2rad(angles - nearest_deg))
        best = int(np.argmax(np.abs(facing)))
        by_um = -number_of(row, "size_um") * float(facing[best])
        await self.go(sweep.pose(sweep.values_deg[best]))
        way = "towards" if by_um > 0.0 else "away from"
        answer = await self.ctx.ask(
            TAP.prompt(
                f"{self.reading.mounting}/tap/{number}",
                f"Tap the artefact {abs(by_um):.0f} µm {way} indicator x, until that reads "
                f"{number_of(row, 'mean_um'):.0f} µm, then confirm: the run-out is read again.",
                task=TapArtefact(by_um=round(by_um, 1)),
                target=sweep.start,
            )
        )
        if answer != "yes":
            raise AlignmentError(
                f"the operator did not tap the artefact; it runs {number_of(row, 'size_um'):.0f} µm off the axis, "
                f"accepted are {self.within_um:g} µm"
            )
        return {"by_um": by_um}
