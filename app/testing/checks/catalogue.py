"""All checks of the conformance suite."""

from catseye.app.testing.candidate import Candidate
from catseye.app.testing.checks import environment, identity, interferometer, link, robot, shape
from catseye.app.testing.checks.check import Check

ALL: tuple[Check, ...] = (
    *shape.CHECKS,
    *link.CHECKS,
    *identity.CHECKS,
    *interferometer.CHECKS,
    *environment.CHECKS,
    *robot.CHECKS,
)


def applicable(candidate: Candidate) -> list[Check]:
    """Return the checks that apply to a driver."""
    return [check for check in ALL if check.obstacle(candidate) is None]


def not_applicable(candidate: Candidate) -> dict[str, str]:
    """Return the checks of a driver's kind that do not apply to it, with the reason."""
    own = [check for check in ALL if candidate.role in check.roles]
    return {check.name: reason for check in own if (reason := check.obstacle(candidate)) is not None}
