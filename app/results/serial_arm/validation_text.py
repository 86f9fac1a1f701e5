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
    inside_95_percent: float | None,
    fitted: Sequence[str],
    dead_paths: Sequence[str],
    assumed_u_mm: float | None = None,
) -> list[Statement]:
    """Return what the calibrated arm leaves, and what has to be known about that.

    Args:
        measured: how many targets or lengths.
        drawn: `mean_mm` and `max_mm` of the errors of the arm as drawn; None where they are not known.
        calibrated: the same of the calibrated arm.
        inside_95_percent: share of the errors within the 95 % region of the uncertainties; None where nobody knows.
        fitted: anchors whose places are fitted.
        dead_paths: anchors whose dead paths are fitted.
        assumed_u_mm: scatter that rows without uncertainties were taken to have; None where they state their own.
    """
    honest = inside_95_percent is not None and inside_95_percent >= _HONEST_PERCENT
    judged = Sign.GOOD if honest else Sign.ATTENTION
    said = [
        Statement(
            Sign.NEUTRAL if inside_95_percent is None else judged,
            f"{measured}: the calibrated arm misses them by {calibrated['mean_mm']:.3f} mm on "
            f"the average, {calibrated['max_mm']:.3f} mm at most.",
            _short(drawn, calibrated),
        ),
        _inside(inside_95_percent, assumed_u_mm, honest=honest),
    ]
    if fitted:
        said.append(
            Statement(
                Sign.ATTENTION,
                f"The position of {', '.join(fitted)} is not known: each state of the arm has its own best place, "
                "which absorbs a part of the errors. State it by --anchors.",
            )
        )
    if dead_paths:
        said.append(
            Statement(
                Sign.ATTENTION,
                f"The result does not know the dead path of {', '.join(dead_paths)}: each state of the arm has its "
                "own best one, which absorbs the mean of its errors.",
            )
        )
    return said


def _inside(percent: float | None, assumed_u_mm: float | None, *, honest: bool) -> Statement:
    if percent is None:
        return Statement(
            Sign.NEUTRAL,
            "The table states no uncertainties, and the calibration had other rows or a robust loss: whether the "
            "errors are as large as they may be is not judged. State u_mm.",
        )
    rows = (
        "of the stated uncertainties"
        if assumed_u_mm is None
        else f"of predictions and rows. The table states no u_mm: its rows were taken to scatter as those of the "
        f"calibration, by {assumed_u_mm:.2g} mm"
    )
    return Statement(
        Sign.NEUTRAL if honest else Sign.ATTENTION,
        f"{percent:.0f} % of the errors lie within the 95 % region {rows}.",
    )


def _short(drawn: Mapping[str, float] | None, calibrated: Mapping[str, float]) -> str:
    after = f"calibrated {calibrated['mean_mm']:.3f} mm"
    return after if drawn is None else before_and_after(f"as drawn {drawn['mean_mm']:.3f} mm", after)
