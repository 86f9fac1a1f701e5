"""What a calibrated arm leaves on measurements that it has not seen, in sentences."""

from collections.abc import Mapping, Sequence
from typing import Final

from catseye.app.results.model import Sign, Statement
from catseye.app.results.said import before_and_after

_HONEST_PERCENT: Final = 90.0
"""So many errors at least lie within the 95 % region of honest uncertainties."""


def validation_statements(
    measured: str,
    drawn: Mapping[str, float] | None,
    calibrated: Mapping[str, float],
    inside_95_percent: float,
    fitted: Sequence[str],
    dead_paths: Sequence[str],
) -> list[Statement]:
    """Return what the calibrated arm leaves, and what has to be known about that.

    Args:
        measured: how many targets or lengths.
        drawn: `mean_mm` and `max_mm` of the errors of the arm as drawn; None where they are not known.
        calibrated: the same of the calibrated arm.
        inside_95_percent: share of the errors within the 95 % region of the stated uncertainties.
        fitted: anchors whose places are fitted.
        dead_paths: anchors whose dead paths are fitted.
    """
    honest = inside_95_percent >= _HONEST_PERCENT
    said = [
        Statement(
            Sign.GOOD if honest else Sign.NEUTRAL,
            f"{measured}: the calibrated arm misses them by {calibrated['mean_mm']:.3f} mm on "
            f"the average, {calibrated['max_mm']:.3f} mm at most.",
            _short(drawn, calibrated),
        ),
        Statement(
            Sign.NEUTRAL if honest else Sign.ATTENTION,
            f"{inside_95_percent:.0f} % of the errors lie within the 95 % region of the stated uncertainties.",
        ),
    ]
    if fitted:
        said.append(
            Statement(
                Sign.ATTENTION,
                f"Nobody said where {', '.join(fitted)} stands: each state of the arm has its own best place, "
                "which takes a part of the errors. State it by --anchors.",
            )
        )
    if dead_paths:
        said.append(
            Statement(
                Sign.ATTENTION,
                f"The result does not know the dead path of {', '.join(dead_paths)}: each state of the arm has "
                "its own best one, which takes the mean of its errors.",
            )
        )
    return said


def _short(drawn: Mapping[str, float] | None, calibrated: Mapping[str, float]) -> str:
    after = f"calibrated {calibrated['mean_mm']:.3f} mm"
    return after if drawn is None else before_and_after(f"as drawn {drawn['mean_mm']:.3f} mm", after)
