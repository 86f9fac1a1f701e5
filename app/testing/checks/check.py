"""One check of the conformance suite: what it needs, and how it is run."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Literal

from catseye.app.testing.candidate import Candidate
from catseye.app.testing.trial import NotConformingError, Trial, trial_of
from catseye.drivers.roles.device import ROLES, Role

Need = Literal["proxy", "bench", "motion", "streaming"]

_REASONS: dict[Need, str] = {
    "proxy": "faults of a link can be made on TCP links only: reach the device through a serial device server",
    "bench": "needs the truth about what is measured: give --control URL of an emulated bench",
    "motion": "moves the robot: give --allow-motion when it may move",
    "streaming": "give --streaming TEXT if the device can be left sending without being asked",
}
_LONGEST_S = 60.0


@dataclass(frozen=True)
class Check:
    """Something that a driver has to do.

    Attributes:
        body: does it; its docstring says what is asked of the driver.
        roles: of the drivers that it concerns.
        needs: what has to be there.
    """

    body: Callable[[Trial], Awaitable[None]]
    roles: tuple[Role, ...] = ROLES
    needs: tuple[Need, ...] = ()

    @property
    def name(self) -> str:
        """As reports call it."""
        return self.body.__name__

    def obstacle(self, candidate: Candidate) -> str | None:
        """Return why the check does not apply to a driver; None when it does."""
        if candidate.role not in self.roles:
            return f"concerns {' and '.join(self.roles)} drivers"
        present: dict[Need, bool] = {
            "proxy": candidate.has_proxy,
            "bench": candidate.has_bench,
            "motion": candidate.may_move,
            "streaming": bool(candidate.streaming),
        }
        return next((_REASONS[need] for need in self.needs if not present[need]), None)


def run_check(check: Check, candidate: Candidate) -> None:
    """Run a check on a bench of its own, on an event loop of its own.

    Raises:
        NotConformingError: the driver does not conform.
        NotApplicableError: this device does not show what the check looks for.
    """
    with trial_of(candidate) as trial:
        asyncio.run(_bounded(check, trial))


async def _bounded(check: Check, trial: Trial) -> None:
    try:
        async with asyncio.timeout(_LONGEST_S) as limit:
            await check.body(trial)
    except TimeoutError as error:
        if not limit.expired():
            raise NotConformingError(
                "a TimeoutError came out of the driver: raise LinkTimeoutError with a text that names the device"
            ) from error
        raise NotConformingError(f"{check.name} did not end within {_LONGEST_S:g} s") from None
