"""What the terms on screens and pages mean; docs/glossary.md is written from here."""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Term:
    """A term.

    Attributes:
        name: as screens have it; several spellings are separated by commas.
        text: what it means, in a sentence or two.
    """

    name: str
    text: str


_TERMS: Final = (
    Term(
        "acceptance, max miss",
        "The acceptance is the largest distance from a reflector's centre at which the beam still returns. The "
        "plan keeps the beam's distance from the centre, its miss, below max_miss_mm.",
    ),
    Term(
        "aim",
        "The angle of J4 at which the beam hits a reflector. It follows from the places of the reflectors and the "
        "beam's zero direction θ40, both found by a search.",
    ),
    Term(
        "AP, positioning accuracy",
        "ISO 9283: the distance between the commanded position and the mean of those attained, for one pose.",
    ),
    Term(
        "backlash, reversal, reversal error, lost motion",
        "Difference between the positions that one command reaches from below and from above. It is caused by play "
        "between the gear's flanks, friction and elasticity.",
    ),
    Term(
        "calibrated arm",
        "The arm with identified parameters. The nominal (drawn) arm has parameters from drawings instead.",
    ),
    Term("candidates", "Random poses, from which those that identify the parameters best are chosen."),
    Term(
        "closure, return",
        "A visit to an early pose without losing the beam in between; the change of its distance is drift.",
    ),
    Term(
        "conventional model",
        "A model with links and one offset of J2 but no error maps, as most controllers have. Comparing its "
        "residuals with those of the error map shows what the map gains.",
    ),
    Term(
        "contribution",
        "Part of a result's uncertainty that comes from one contributor of the error budget, such as the air or "
        "the radial error of J4.",
    ),
    Term(
        "dead path",
        "Constant part of every distance of a segment. The interferometer counts changes only, so its length at "
        "the zero is unknown and identified together with the arm.",
    ),
    Term("dwell", "Time at standstill over which readings are averaged."),
    Term(
        "drift",
        "Slow change of the measured distance or position although nothing is moved. Warm up first.",
    ),
    Term(
        "E_s, step error",
        "Measured minus commanded step, over the commanded step, in per cent. The curve is its moving mean "
        "over eleven steps.",
    ),
    Term(
        "E_XX, E_YY, E_ZZ",
        "Error of a linear motion along its own axis: the first letter is the direction of the error, the "
        "second the axis of the motion (ISO 230-1). E_YY is the positioning error along Y on a path along Y.",
    ),
    Term(
        "E_XY, E_YX",
        "Straightness error: the error in X of a motion along Y, and the other way round (ISO 230-1).",
    ),
    Term(
        "Eq. 2",
        "Equation 2 of the SCARA paper: the angle of J4 at which the beam hits a reflector, from the arm's "
        "pose, the reflector's place and the beam's zero direction θ40. The search solves it for all "
        "reflectors together.",
    ),
    Term(
        "error budget",
        "List of the contributors to the uncertainty of a distance, with their sizes, in [uncertainty] of the cell "
        "file.",
    ),
    Term(
        "ET, ER, EA, tangential, radial, axial error",
        "Errors of a turning axis: along the circle of a point, towards the axis, and along the axis.",
    ),
    Term(
        "frames only",
        "The nominal arm with only base and tool fitted. The remaining errors are those of the arm itself.",
    ),
    Term(
        "gauge",
        "A convention for a quantity that distances cannot determine, such as the zero of the J1 map, whose mean "
        "is set to 0.",
    ),
    Term(
        "identify",
        "To determine links, error maps and reflector places from the measured distances, with their uncertainties.",
    ),
    Term(
        "innovation",
        "Measured distance minus the one predicted from all points before it. Within its band the new point "
        "agrees with what is known.",
    ),
    Term(
        "k = 1, u, standard uncertainty",
        "Standard uncertainty u: the standard deviation of the values that the quantity could reasonably have; "
        "about 68 % lie within ±u. Files hold u.",
    ),
    Term(
        "k = 2, U, expanded uncertainty",
        "Expanded uncertainty U = 2 u: about 95 % lie within ±U. Screens, reports and error bars show U.",
    ),
    Term(
        "least increment step, LIS",
        "The smallest step down to which the step error, averaged over eleven steps, stays within the threshold "
        "(10 %).",
    ),
    Term(
        "LOWESS",
        "Smoothing by locally weighted straight lines through the neighbours of each sample. It smooths the "
        "velocity in a recording, so that each step appears as one peak.",
    ),
    Term(
        "map, error map, Δθ1, Δθ2",
        "Angular positioning deviation of a joint at its nodes, for approaches from below (▲) and from above "
        "(▼), in mdeg.",
    ),
    Term("mdeg", "Thousandth of a degree, 17.5 µrad. At a reach of 550 mm it moves the tool by 9.6 µm."),
    Term("nest", "A seat that holds a reflector or the target of a tracker at the same place each time."),
    Term("node", "Joint position at which a map has a value. Between nodes the map is interpolated."),
    Term(
        "null direction",
        "A combination of parameters that the measurements cannot determine. It is named and gets no value.",
    ),
    Term(
        "O1 … O5, observability index",
        "Figures of merit for how well a set of poses identifies the parameters, computed from singular values. "
        "Larger is better.",
    ),
    Term(
        "open loop, open-loop tracking",
        "The robot itself aims the beam at a reflector by its joint positions, without a tracking sensor that "
        "corrects.",
    ),
    Term(
        "outlier",
        "A point that deviates from the fit by far more than its uncertainty. It is named and may be left out.",
    ),
    Term(
        "overlap",
        "A pose that is measured again after the beam was lost. The difference links the two segments.",
    ),
    Term(
        "override",
        "Speed of the controller in per cent of the programmed speed. The program limits it to a cap.",
    ),
    Term(
        "p, probability",
        "Probability that chance alone gives a result at least as extreme. Below 0.01 chance is not accepted as "
        "the explanation.",
    ),
    Term("pitch", "Angle of the beam to the horizontal; levelling makes it zero."),
    Term("plateau", "Standstill between two steps in a recording; its mean is the position after the step."),
    Term("residual", "Measured minus fitted value of a point that took part in the fit, in µm."),
    Term("rms", "Root mean square: the square root of the mean of the squares."),
    Term(
        "RP, repeatability",
        "ISO 9283: radius within which the arrivals at one pose lie: mean distance from their centre plus "
        "three standard deviations. Along one beam: ±3 S.",
    ),
    Term("run-in", "A motion in the test's direction before the test, so that play is taken up."),
    Term("S", "Standard deviation of repeated arrivals along one beam."),
    Term("segment", "The distances measured between two losses of the beam. They share one dead path."),
    Term("settling", "Wait after a motion until the value stands still."),
    Term(
        "sigma0, σ0",
        "Root mean square of the residuals, each divided by its stated uncertainty. It is 1 if residuals and "
        "budget agree.",
    ),
    Term(
        "take-up",
        "A motion beyond the target and back, so that a joint arrives from the intended side with its backlash "
        "taken up.",
    ),
    Term(
        "target",
        "What a tracker or an optical CMM measures on the tool: a reflector in its nest, or a plate of marks.",
    ),
    Term(
        "threshold",
        "Limit of the step error by which least steps are judged, 10 % after the resolution paper.",
    ),
    Term(
        "walk",
        "Driving a plan once, slowly and without measuring, while Space is held. The key is not an enabling device.",
    ),
    Term(
        "world frame",
        "Coordinates spanned by three nests on the table: the first is the origin, the second lies on x, the "
        "third in the plane of x and y.",
    ),
    Term(
        "θ20",
        "Offset of J2's zero, identified in the conventional model only; with error maps it is part of them.",
    ),
    Term("θ40", "Direction of the beam at J4 = 0, found by a search."),
)

GLOSSARY: Final = tuple(sorted(_TERMS, key=lambda term: term.name.lower()))


def glossary_markdown() -> str:
    """Return the terms as docs/glossary.md has them."""
    rows = [f"| {term.name} | {term.text} |" for term in GLOSSARY]
    return "\n".join(["| term | means |", "|---|---|", *rows])
