"""Questions about the arm whose motion resolution is measured, and about the optics."""

from collections.abc import Callable
from typing import Final

from catseye.app.cell.arm import arm_description, shipped_arms
from catseye.app.cell.wizard.question import Question

Answer = Callable[[str], str]

OPTICS: Final = "Interferometer and retroreflector for angles, and for straight steps."
"""Above the questions about optics."""


def arm(answer: Answer) -> list[Question]:
    """Return what is asked about the arm and the ranges of its joints."""
    return [
        Question(
            "robot.arm",
            "Arm",
            f"{', '.join(shipped_arms())}, or the path of a description of your own (TOML)",
            find_out="lengths, ranges and speeds of the arm: its maker's data sheet",
        ),
        *_limits(answer("robot.arm")),
    ]


def _limits(name: str) -> list[Question]:
    """Return what is asked about ranges; nothing while the arm is not known."""
    try:
        joints = arm_description(name).joint
    except ValueError:
        return []
    return [
        Question(
            f"robot.limits_deg.{joint.name.lower()}",
            f"Limits of {joint.name}, {'deg' if joint.type == 'revolute' else 'mm'}",
            "two numbers, lowest and highest; narrower than the arm's own, and mind the cables",
            "numbers",
            default=f"{joint.range[0]:g}, {joint.range[1]:g}",
        )
        for joint in joints
    ]


def optics() -> list[Question]:
    """Return what is asked about the optics."""
    spacing = Question(
        "angular_optics.spacing_mm",
        "Prism spacing, mm",
        "of the angular retroreflector: the sine of an angle is the displacement divided by this spacing",
        "number",
        find_out="the distance of the two prisms: the certificate of the angular optics",
    )
    further = (
        ("angular_optics.u_spacing_mm", "u(spacing), mm", "standard uncertainty of the spacing"),
        (
            "angular_optics.distance_mm",
            "Distance, mm",
            "from the angular interferometer to its retroreflector",
        ),
        ("angular_optics.signal_min", "Least signal, 0 … 1", "weaker returns are not used"),
        (
            "linear_optics.distance_mm",
            "Linear: distance, mm",
            "from the linear interferometer to its retroreflector",
        ),
        ("linear_optics.signal_min", "Linear: least signal", "0 … 1, for straight steps"),
    )
    return [spacing, *(Question(key, title, text, "number") for key, title, text in further)]
