"""What a calibrated arm leaves on measurements that it has not seen, in sentences."""

from typing import TYPE_CHECKING

from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import counted
from catseye.app.results.said import before_and_after

if TYPE_CHECKING:
    # A validation states itself by these sentences.
    from catseye.app.results.serial_arm.validation import ArmValidation


def validation_statements(found: "ArmValidation") -> list[Statement]:
    """Return what the calibrated arm leaves, and what has to be known about that."""
    after = found.calibrated.figures()
    what = "measured length" if found.of_distances else "measured target"
    said = [
        Statement(
            Sign.GOOD,
            f"{counted(len(found.targets), what)}: the calibrated arm misses them by {after['mean_mm']:.3f} mm on "
            f"the average, {after['max_mm']:.3f} mm at most.",
            _short(found),
        ),
        Statement(
            Sign.NEUTRAL if found.inside_95_percent >= 90.0 else Sign.ATTENTION,
            f"{found.inside_95_percent:.0f} % of the errors lie within the 95 % region of the stated uncertainties.",
        ),
    ]
    if found.fitted:
        said.append(
            Statement(
                Sign.ATTENTION,
                f"Nobody said where {', '.join(found.fitted)} stands: each state of the arm has its own best place, "
                "which takes a part of the errors. State it by --anchors.",
            )
        )
    if found.dead_paths:
        said.append(
            Statement(
                Sign.ATTENTION,
                f"The result does not know the dead path of {', '.join(found.dead_paths)}: each state of the arm has "
                "its own best one, which takes the mean of its errors.",
            )
        )
    return said


def _short(found: "ArmValidation") -> str:
    after = f"calibrated {found.calibrated.figures()['mean_mm']:.3f} mm"
    if found.frames_only is None:
        return after
    return before_and_after(f"as drawn {found.frames_only.figures()['mean_mm']:.3f} mm", after)
