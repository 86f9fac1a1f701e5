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
        "How far from the centre of a reflector the beam may hit and still return is its acceptance; the plan "
        "keeps the beam's miss below max_miss_mm.",
    ),
    Term(
        "aim",
        "Where J4 has to point so that the beam hits a reflector. It follows from the places of the reflectors "
        "and the beam's zero direction θ40, which a search finds.",
    ),
    Term(
        "AP, positioning accuracy",
        "ISO 9283: the distance between the commanded position and the mean of those attained, for one pose.",
    ),
    Term(
        "backlash, reversal, reversal error, lost motion",
        "Difference of the positions that one command reaches from below and from above. Play between the "
        "gear's flanks is a part of it, friction and elasticity are others.",
    ),
    Term(
        "calibrated arm",
        "The arm with identified parameters, as opposed to the drawn (nominal) arm, whose parameters come from "
        "drawings.",
    ),
    Term("candidates", "Random poses, of which the ones that identify the parameters best are chosen."),
    Term(
        "closure, return",
        "A visit to an early pose without losing the beam in between; the change of its distance is drift.",
    ),
    Term(
        "conventional model",
        "Links and one offset of J2, no error maps: the model that most controllers have. Its "
        "residuals, compared with those of the error map, show what the map gains.",
    ),
    Term(
        "contribution",
        "Share of one contributor of the error budget, such as air or the radial error of J4, in the "
        "uncertainty of a result.",
    ),
    Term(
        "dead path",
        "Constant part of every distance of a segment: the interferometer counts changes only, so the length "
        "at its zero is unknown and identified along with the arm.",
    ),
    Term("dwell", "Time at standstill over which readings are averaged."),
    Term(
        "drift",
        "Slow change of the measured distance or position while nothing should change; warm up first.",
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
        "The contributors to the uncertainty of a distance with their sizes; stated in [uncertainty] of the "
        "cell file.",
    ),
    Term(
        "ET, ER, EA, tangential, radial, axial error",
        "Errors of a turning axis: along the circle of a point, towards the axis, and along the axis.",
    ),
    Term(
        "frames only",
        "The drawn arm with base and tool fitted: what remains then is the error of the arm itself.",
    ),
    Term(
        "gauge",
        "A choice that distances leave open, such as the zero of the J1 map: its mean is set to 0.",
    ),
    Term(
        "identify",
        "To compute links, error maps and reflector places from the measured distances, with their "
        "uncertainties.",
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
        "The smallest step whose error, as a mean over eleven steps, stays within the threshold (10 %) down "
        "to it.",
    ),
    Term(
        "LOWESS",
        "Locally weighted straight lines through the neighbours of each sample: it smooths the velocity in a "
        "recording, so that each step shows as one peak.",
    ),
    Term(
        "map, error map, Δθ1, Δθ2",
        "Angular positioning deviation of a joint at its nodes, for approaches from below (▲) and from above "
        "(▼), in mdeg.",
    ),
    Term("mdeg", "Thousandth of a degree, 17.5 µrad: at 550 mm reach it moves the tool by 9.6 µm."),
    Term("nest", "A seat that holds a reflector or the target of a tracker at the same place each time."),
    Term("node", "Joint position at which a map has a value; between nodes it is interpolated."),
    Term(
        "null direction",
        "A combination of parameters that the measurements cannot determine; it is named, and no number is "
        "invented for it.",
    ),
    Term(
        "O1 … O5, observability index",
        "Figures for how well a set of poses identifies the parameters, from the singular values; larger is "
        "better.",
    ),
    Term(
        "open loop, open-loop tracking",
        "The robot itself aims the beam at a reflector by its joint positions, without a tracking sensor that "
        "corrects.",
    ),
    Term(
        "outlier",
        "A point that the fit contradicts far beyond its uncertainty; it is named and may be left out.",
    ),
    Term(
        "overlap",
        "A pose that is measured once more after the beam was lost: the difference ties the two segments "
        "together.",
    ),
    Term("override", "Per cent of the programmed speed that the controller drives at; the program caps it."),
    Term(
        "p, probability",
        "How often chance alone would give something at least as extreme; below 0.01 chance does not explain "
        "it.",
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
    Term("segment", "Distances between two losses of the beam; they share one dead path."),
    Term("settling", "Wait after a motion until the value stands still."),
    Term(
        "sigma0, σ0",
        "Root mean square of the residuals, each divided by the uncertainty that the budget states: 1 if both agree.",
    ),
    Term(
        "take-up",
        "A motion beyond the target and back, by which a joint arrives from the proper side with its backlash "
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
        "Driving a plan slowly once, without measuring, while Space is held, which is not an enabling device.",
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
    Term("θ40", "Direction of the beam at J4 = 0, as a search has found it."),
)

GLOSSARY: Final = tuple(sorted(_TERMS, key=lambda term: term.name.lower()))


def glossary_markdown() -> str:
    """Return the terms as docs/glossary.md has them."""
    rows = [f"| {term.name} | {term.text} |" for term in GLOSSARY]
    return "\n".join(["| term | means |", "|---|---|", *rows])
