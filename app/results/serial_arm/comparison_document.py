"""Two results of a serial arm, as `compare --json` writes them."""

from catseye.app.results.document import Document


class ComparedParameter(Document):
    """A parameter that both results identified, in its unit.

    Attributes:
        difference: the second minus the first.
        u: of the difference.
        normalised: the difference in units of u; null where u is none.
    """

    name: str
    unit: str
    first: float
    second: float
    difference: float
    u: float
    normalised: float | None


class PlacesApart(Document):
    """How far the two arms are apart at random poses, their frames brought together."""

    poses: int
    mean_mm: float
    max_mm: float


class ArmComparisonDocument(Document):
    """Everything that a comparison found.

    Attributes:
        first: file of the first result.
        second: file of the other.
        only_in_one: parameters that one of them identified.
        within: parameters of the arm that agree within 2 u.
        judged: parameters of the arm that have a difference in units of u.
        target: whose places are compared.
        limit_u: largest difference that is no alarm, in combined standard uncertainties; None without a limit.
        beyond: names of the parameters of the arm beyond the limit.
    """

    first: str
    second: str
    parameters: list[ComparedParameter]
    only_in_one: list[str]
    within: int
    judged: int
    target: str
    places_apart: PlacesApart
    limit_u: float | None
    beyond: list[str]
