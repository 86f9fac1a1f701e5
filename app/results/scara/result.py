"""Result JSON, version 1: an identified arm with its uncertainties."""

import json
import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from catseye.app.files.atomic import write_atomically
from catseye.app.files.column_rules import LARGEST_NUMBER
from catseye.app.results.provenance import Provenance
from catseye.app.results.result_file import read_result_file
from catseye.app.results.scara.budget_part import BudgetPart
from catseye.app.results.uncertainty_part import (
    Finite,
    ResultColumns,
    ResultPart,
    Uncertainty,
    UncertaintyPart,
)
from catseye.calibration.scara.budget import Kind
from catseye.calibration.scara.extension import Part, Source, Target, Term

Length = Annotated[float, Field(gt=0.0, le=LARGEST_NUMBER, allow_inf_nan=False)]


class Estimate(ResultPart):
    """A value with its standard uncertainty (k = 1)."""

    value: Finite
    u: Uncertainty


class MapTable(ResultColumns):
    """A bidirectional map at its nodes."""

    node_deg: list[Finite]
    positive_mdeg: list[Finite]
    negative_mdeg: list[Finite]
    u_positive_mdeg: list[Uncertainty]
    u_negative_mdeg: list[Uncertainty]

    @property
    def by_direction(self) -> tuple[tuple[int, list[float], list[float]], ...]:
        """Direction of approach (1 upwards, -1 downwards), deviations and their standard uncertainties, mdeg."""
        return (1, self.positive_mdeg, self.u_positive_mdeg), (-1, self.negative_mdeg, self.u_negative_mdeg)


class Place(ResultPart):
    """Where a reflector stands."""

    name: str
    x_mm: Estimate
    y_mm: Estimate


class DeadPath(ResultPart):
    """Beam length at a segment's zero."""

    reflector: str
    segment: int
    length_mm: Estimate


class LackOfFitPart(ResultPart):
    """Test against repeated poses."""

    systematic_um: float
    pure_um: float
    ratio: float
    probability: float
    significant: bool

    @model_validator(mode="before")
    @classmethod
    def _of_older_versions(cls, data: object) -> object:
        """Results of version 0.x judged white errors, and noted beside it what stated errors explain."""
        return {**data, "significant": False} if isinstance(data, dict) and data.get("explained") else data


class RobustPart(ResultPart):
    """What a robust loss made of the distances."""

    loss: Literal["huber", "soft-l1"]
    sigma_um: Finite
    half: Finite
    counted_little: int


class Fit(ResultPart):
    """Quality of the fit."""

    n_points: int
    n_returns: int | None = None
    n_parameters: int
    dof: int
    rms_um: float
    sigma0_um: float
    iterations: int
    rejected: list[str]
    null_directions: list[list[str]]
    chi2_reduced: float | None = None
    chi2_probability: float | None = None
    variance_ratio: float = 1.0
    row_variance_mm2: float | None = None
    lack_of_fit: LackOfFitPart | None = None
    robust: RobustPart | None = None

    @model_validator(mode="before")
    @classmethod
    def _from_one_factor(cls, given: Any) -> Any:
        """Read `variance_factor` of earlier files: a ratio, or mm² where no uncertainty was stated."""
        if not isinstance(given, dict) or "variance_factor" not in given:
            return given
        factor, sigma0_um = given["variance_factor"], given.get("sigma0_um")
        unstated = given.get("chi2_reduced") is None
        if given.get("robust") is not None and isinstance(factor, float) and isinstance(sigma0_um, float):
            # A robust fit has no χ²; its factor is the variance of a row where none was stated.
            unstated = math.isclose(factor, (1e-3 * sigma0_um) ** 2, rel_tol=1e-9)
        return given | {"row_variance_mm2" if unstated else "variance_ratio": factor}


class Nominal(ResultPart):
    """Links that command positions are calculated with."""

    link1_mm: Length
    link2_mm: Length


class TermEstimate(ResultPart):
    """A function beyond the model with its coefficient, mdeg or µm."""

    target: Target
    source: Source
    part: Part
    order: int
    unit: Literal["mdeg", "um"]
    value: Finite
    u: Finite


def term_unit(term: Term) -> float:
    """Return what makes mdeg or µm of a term's coefficient in rad or mm."""
    return 1e3 * math.degrees(1.0) if term.angular else 1e3


class TakenUpPart(ResultPart):
    """What the parameters have taken up of a contributor that comes again where the arm goes later.

    Attributes:
        contributor: its place in the result's budget.
        matrix: what its sources of unit variance have moved the parameters by, mm and rad, a row a parameter.
    """

    contributor: int
    matrix: list[list[Finite]]


class Covariance(ResultPart):
    """Covariance of the arm's parameters, mm and rad."""

    names: list[str]
    matrix: list[list[Finite]]
    taken_up: list[TakenUpPart] | None = None


class Residuals(ResultColumns):
    """Residual (predicted minus measured) of each distance, as columns."""

    reflector: list[str]
    segment: list[int]
    theta1_deg: list[Finite]
    theta2_deg: list[Finite]
    direction1: list[int]
    direction2: list[int]
    residual_um: list[Finite]


class ScanSegments(ResultColumns):
    """Residuals by segment, as columns."""

    reflector: list[str]
    segment: list[int]
    n_points: list[int]
    mean_um: list[Finite]
    rms_um: list[Finite]
    largest_um: list[Finite]


class ScanPart(ResultPart):
    """Residuals of all distances, summed up; `residuals` of the result holds an even sample of them.

    Without a search for distances that repeat each other nothing is tested for lack of fit.
    """

    lack_of_fit_tested: bool = False
    n_points: int
    n_sample: int
    segments: ScanSegments
    histogram_from_um: float
    histogram_to_um: float
    histogram: list[int]


class DriftPart(ResultPart):
    """What a contributor that changes with time did during the measurement.

    Attributes:
        contributor: its name in the budget.
        unit: of what changed; ppm for links and scale.
        change: from the beginning to the end.
        rms: about its mean.
        probability: of distances that show so much when nothing changed.
        significant: it did change.
    """

    contributor: str
    kind: Kind
    unit: Literal["um", "ppm"]
    change: Estimate
    rms: Estimate
    probability: Uncertainty
    significant: bool


class J4OrderPart(ResultPart):
    """An order of J4's angle in the distance that the interferometer in two mountings has separated from the maps.

    Attributes:
        contributor: its name in the budget.
        order: multiple of J4's angle.
        cosine_um: in the first mounting.
        sine_um: likewise.
        amplitude_um: of both together.
    """

    contributor: str
    order: int
    cosine_um: Estimate
    sine_um: Estimate
    amplitude_um: Estimate


class Implausible(ResultPart):
    """What speaks against the arm, and the reason why it was kept all the same."""

    accepted: str
    findings: list[str]


class Result(ResultPart):
    """A whole result file."""

    format: Literal["catseye-result/1"] = "catseye-result/1"
    model: Literal["conventional", "error-map"]
    gauge: str
    link1_mm: Estimate
    link2_mm: Estimate
    link1_20c_mm: Estimate | None = None
    link2_20c_mm: Estimate | None = None
    material_c: float | None = None
    theta20_mdeg: Estimate | None = None
    theta1_map: MapTable | None = None
    theta2_map: MapTable | None = None
    reflectors: list[Place]
    dead_paths: list[DeadPath]
    fit: Fit
    nominal: Nominal | None = None
    extension: list[TermEstimate] | None = None
    covariance: Covariance | None = None
    residuals: Residuals | None = None
    uncertainty: UncertaintyPart | None = None
    budget: BudgetPart | None = None
    drift: list[DriftPart] | None = None
    j4_orders: list[J4OrderPart] | None = None
    scan: ScanPart | None = None
    implausible: Implausible | None = None
    provenance: Provenance

    @property
    def has_maps(self) -> bool:
        """The model has a map of each joint."""
        return self.theta1_map is not None and self.theta2_map is not None


def result_text(result: Result) -> str:
    """Return the text of a result file."""
    return json.dumps(result.model_dump(exclude_none=True), ensure_ascii=False, indent=1) + "\n"


def write_result(result: Result, path: Path) -> None:
    """Write a result file, whole or not at all."""
    write_atomically(path, result_text(result))


def read_result(path: Path) -> Result:
    """Read a result file.

    Raises:
        UsageError: the file is missing or no result; names what is wrong.
    """
    return read_result_file(path, Result, "catseye identify")
