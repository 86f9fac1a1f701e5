"""How far the arm travels until STOP is written, by cause: what somebody beside it has to reckon with."""

from dataclasses import dataclass

from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.motion.body_speed import top_speed_mm_s


@dataclass(frozen=True)
class StopCause:
    """Why the arm is stopped, and how long that takes.

    Attributes:
        text: what happens.
        limit_s: longest time from there to STOP on the controller's wire, s; docs/evidence.md
            has the figures.
    """

    text: str
    limit_s: float


STOP_CAUSES = (
    StopCause("the STOP key", 0.05),
    StopCause("the program killed", 0.1),
    StopCause("the door opened", 0.3),
    StopCause("the door's input silent", 0.4),
    StopCause("the program stopped or blocked", 0.7),
)


def stopping_text(bench: Bench, percent: float) -> str:
    """Return how far the fastest point of the arm can travel until STOP is written, by cause, in words.

    Args:
        bench: bodies and fastest joints, as the cell file states them.
        percent: speed override.
    """
    speed_mm_s = top_speed_mm_s(bench, percent)
    travels = ", ".join(f"{cause.text} {speed_mm_s * cause.limit_s:.0f} mm" for cause in STOP_CAUSES)
    return (
        f"at an override of {percent:g} % nothing on the arm is faster than {speed_mm_s:.0f} mm/s; until STOP is "
        f"written it travels at most: {travels}; the controller's own reaction and braking come on top: measure them"
    )
