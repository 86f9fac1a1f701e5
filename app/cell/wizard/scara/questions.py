"""Questions about a SCARA's arm, its beam and its nodes."""

from typing import Final

from catseye.app.cell.wizard.question import YES_NO, Question

REFLECTORS: Final = "Rough places from the J1 axis; ±20 mm are enough."
"""Above the table of reflectors."""


def nominal_arm() -> list[Question]:
    """Return what is asked about links and height."""
    return [
        Question("robot.link1_mm", "Link 1, mm", "from J1 to J2, nominal, from the catalogue", "number"),
        Question("robot.link2_mm", "Link 2, mm", "from J2 to J4, nominal, from the catalogue", "number"),
        Question(
            "robot.j3_mm",
            "Height J3, mm",
            "where the beam is at the height of the reflectors; beam-level finds it",
            "number",
        ),
        Question(
            "robot.j3_range_mm", "Range of J3, mm", "two numbers: heights that levelling may use", "numbers"
        ),
    ]


def joint_limits() -> list[Question]:
    """Return what is asked about the ranges of the joints."""
    return [
        Question(
            f"robot.limits_deg.{joint}",
            f"Limits of {joint.upper()}, deg",
            "two numbers, lowest and highest; narrower than the controller's own, and mind the cables",
            "numbers",
        )
        for joint in ("j1", "j2", "j4")
    ]


def optics() -> list[Question]:
    """Return what is asked about the beam."""
    asked = [
        (
            "acceptance_mm",
            "Acceptance, mm",
            "the cat's eye returns a beam that misses its centre by less than this",
        ),
        (
            "max_miss_mm",
            "Largest miss, mm",
            "moves are split so that the beam stays this close; below acceptance",
        ),
        ("field_half_angle_deg", "Half field, deg", "largest angle to its axis at which a cat's eye works"),
        ("column_radius_mm", "Base column, mm", "radius of the robot's base, which blocks the beam"),
        ("column_margin_mm", "Column margin, mm", "clearance of the beam from the column"),
        ("theta40_deg", "Beam at J4 = 0, deg", "its direction, roughly; the search finds it"),
        (
            "signal_min",
            "Least signal, 0 … 1",
            "weaker returns are not used; 0: the counter reports no level",
        ),
    ]
    carried = Question(
        "optics.one_reflector",
        "One cat's eye",
        "yes: one reflector serves all nests, and you are asked to move it",
        "choice",
        YES_NO,
    )
    return [*(Question(f"optics.{key}", title, text, "number") for key, title, text in asked), carried]


def measurement() -> list[Question]:
    """Return what is asked about nodes and timing."""
    nodes = "-140 to 60 step 20, or each node: -140, -120, 0; the maps are identified at these"
    asked = [
        ("settle_time_s", "Settling, s", "wait after each motion"),
        ("dwell_time_s", "Dwell, s", "time over which the readings of a point are spread"),
        ("readings", "Readings", "per point"),
        ("take_up_deg", "Take-up, deg", "overshoot at every reversal; larger than any backlash"),
        ("spread_limit_um", "Largest spread, µm", "readings that scatter more are taken again"),
    ]
    return [
        Question("measurement.theta1_deg", "Nodes of J1, deg", nodes, "numbers"),
        Question("measurement.theta2_deg", "Nodes of J2, deg", nodes, "numbers"),
        *(Question(f"measurement.{key}", title, text, "number") for key, title, text in asked),
    ]
