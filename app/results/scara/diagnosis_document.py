"""A diagnosis as JSON."""

from collections.abc import Sequence
from typing import Final, Literal

import numpy as np
from pydantic import AliasChoices, Field

from catseye.app.results.document import Document, Stated
from catseye.app.results.figure_document import FigureParts
from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import MDEG_PER_RAD
from catseye.app.results.scara.diagnosis import coefficients, outlying
from catseye.app.results.scara.diagnosis_findings import distance_text, findings
from catseye.app.results.scara.figures.diagnosis import diagnosis_figures
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.calibration.scara.diagnostics.harmonics import Harmonic, HarmonicSeries
from catseye.calibration.scara.diagnostics.joint_angles import AnglePattern
from catseye.calibration.scara.diagnostics.nested_models import ComparedModel
from catseye.calibration.scara.diagnostics.node_spacing import NodeSpacing

FindingKind = Literal["good", "bad", "note"]

_KINDS: Final[dict[Sign, FindingKind]] = {
    Sign.GOOD: "good",
    Sign.BAD: "bad",
    Sign.NEUTRAL: "note",
    Sign.ATTENTION: "note",
}
_SIGNS: Final[dict[FindingKind, Sign]] = {"good": Sign.GOOD, "bad": Sign.BAD, "note": Sign.NEUTRAL}


class DiagnosisFinding(Document):
    """A sentence that speaks for or against the fit, or neither."""

    kind: FindingKind
    text: str

    @property
    def statement(self) -> Statement:
        """The sentence with its sign."""
        return Statement(_SIGNS[self.kind], self.text)


class DiagnosedFit(Document):
    """The error map that was diagnosed."""

    n_points: int
    n_returns: int | None = None
    n_parameters: int
    rms_um: Stated
    chi2_reduced: Stated
    rejected: list[str]


class ModelTerm(Document):
    """A coefficient of a model beyond the maps."""

    name: str
    unit: Literal["mdeg", "um"]
    value: Stated
    u: Stated


class ModelPart(Document):
    """A model, compared with the one that it extends.

    Attributes:
        base: the model that it extends; None for the smallest.
        refused: why it cannot be identified; None where it can.
        probability: of what it explains, or more, beside all stated errors; it counts all checks of the diagnosis.
        as_stated: it is there, and no larger than the stated errors make it.
    """

    name: str
    base: str | None
    refused: str | None
    n_parameters: int
    rms_um: Stated
    aicc: Stated
    bic: Stated
    explained_um: Stated
    f_ratio: Stated
    probability: float
    significant: bool
    as_stated: bool = False
    terms: list[ModelTerm]


class Outlier(Document):
    """A distance that stands out.

    Attributes:
        row: its number, from 1.
        what: which distance it is.
        internal: studentised residual.
        external: the same, with the scatter of the other distances.
    """

    row: int
    what: str
    residual_um: Stated
    internal: Stated
    external: Stated
    leverage: Stated
    cook: Stated


class InfluentialDistance(Document):
    """The distance without which the fit would change most."""

    row: int
    what: str
    cook: Stated


class Outliers(Document):
    """Distances beyond the limit of the studentised residual, the farthest first."""

    limit: float
    distances: list[Outlier]
    largest_leverage: Stated
    most_influential: InfluentialDistance


class ChangePart(Document):
    """A drift or a jump."""

    kind: str
    reflector: str
    segment: int
    row: int
    within: int
    size_um: Stated
    u_um: Stated
    probability: float
    significant: bool


class PatternPart(Document):
    """Residuals against the angle of a joint."""

    joint: int
    angle_deg: list[float]
    mean_um: list[float]
    count: list[int]
    explained_um: Stated
    f_ratio: Stated
    probability: float


class HarmonicPart(Document):
    """A periodic deviation of one order."""

    order: int
    aliases: list[int]
    amplitude: float
    u: float
    explained_um: float
    false_alarm_probability: float


class HarmonicsPart(Document):
    """Periodic deviations of one quantity over one angle."""

    target: str
    source: str
    unit: Literal["mdeg", "um"]
    absorbed_orders: list[int]
    orders: list[HarmonicPart]


class FoldPart(Document):
    """What was left out in turn, and how well the rest predicts it."""

    name: str
    distances: int = Field(validation_alias=AliasChoices("distances", "rows"))
    identified: bool
    predicted_um: Stated
    in_sample_um: Stated
    expected_um: Stated
    probability: float


class CrossValidationPart(Document):
    """A cross-validation."""

    left_out: str = Field(validation_alias=AliasChoices("left_out", "way"))
    predicted_um: Stated
    in_sample_um: Stated
    expected_um: Stated
    folds: list[FoldPart]


class GridPart(Document):
    """A grid of nodes."""

    name: str
    refused: str | None
    n_parameters: int
    rms_um: Stated
    aicc: Stated
    bic: Stated
    predicted_um: Stated


class NodesPart(Document):
    """How far apart the nodes may be."""

    commands_between_nodes_of_j1: bool
    commands_between_nodes_of_j2: bool
    best_aicc: str
    best_bic: str
    best_prediction: str | None
    grids: list[GridPart]


class DiagnosisDocument(Document):
    """Everything that speaks for or against a fit.

    Attributes:
        sources: names of the runs or of the points file.
    """

    sources: list[str]
    findings: list[DiagnosisFinding]
    fit: DiagnosedFit
    models: list[ModelPart]
    outliers: Outliers
    changes: list[ChangePart]
    patterns: list[PatternPart]
    harmonics: list[HarmonicsPart]
    cross_validation: list[CrossValidationPart]
    nodes: NodesPart
    figures: FigureParts


def diagnosis_document(diagnosis: Diagnosis, names: Sequence[str]) -> DiagnosisDocument:
    """Return a diagnosis as plain values.

    Args:
        names: of the runs or of the points file.
    """
    validations = (diagnosis.reflectors, diagnosis.sweeps, diagnosis.segments)
    return DiagnosisDocument(
        sources=list(names),
        findings=[
            DiagnosisFinding(kind=_KINDS[finding.sign], text=finding.text) for finding in findings(diagnosis)
        ],
        fit=_fit(diagnosis),
        models=[_model(model) for model in diagnosis.models],
        outliers=_outliers(diagnosis),
        changes=[ChangePart.model_validate(change) for change in diagnosis.changes],
        patterns=[_pattern(pattern) for pattern in diagnosis.patterns],
        harmonics=[_series(harmonic) for harmonic in diagnosis.harmonics],
        cross_validation=[CrossValidationPart.model_validate(one) for one in validations if one],
        nodes=_nodes(diagnosis.nodes),
        figures=tuple(diagnosis_figures(diagnosis)),
    )


def _fit(diagnosis: Diagnosis) -> DiagnosedFit:
    fit = diagnosis.identified.fit
    return DiagnosedFit(
        n_points=fit.n_points,
        n_returns=diagnosis.identified.points.returns,
        n_parameters=fit.n_parameters,
        rms_um=fit.rms_um,
        chi2_reduced=fit.chi2_reduced,
        rejected=diagnosis.identified.rejected,
    )


def _model(model: ComparedModel) -> ModelPart:
    return ModelPart(
        name=model.name,
        base=model.base,
        refused=model.refused,
        n_parameters=model.n_parameters,
        rms_um=model.rms_um,
        aicc=model.aicc,
        bic=model.bic,
        explained_um=model.explained_um,
        f_ratio=model.ratio,
        probability=model.probability,
        significant=model.significant,
        as_stated=model.as_stated,
        terms=[
            ModelTerm(
                name=term.name, unit="mdeg" if term.unit == "mdeg" else "um", value=term.value, u=term.u
            )
            for term in coefficients(model)
        ],
    )


def _outliers(diagnosis: Diagnosis) -> Outliers:
    residuals = diagnosis.residuals
    influential = int(np.argmax(np.nan_to_num(residuals.cook)))
    return Outliers(
        limit=diagnosis.outlier_limit,
        distances=[_outlier(diagnosis, row) for row in outlying(diagnosis)],
        largest_leverage=float(residuals.leverage.max()),
        most_influential=InfluentialDistance(
            row=influential + 1,
            what=distance_text(diagnosis, influential),
            cook=float(residuals.cook[influential]),
        ),
    )


def _outlier(diagnosis: Diagnosis, row: int) -> Outlier:
    residuals = diagnosis.residuals
    return Outlier(
        row=row + 1,
        what=distance_text(diagnosis, row),
        residual_um=1e3 * float(diagnosis.identified.residuals_mm[row]),
        internal=float(residuals.internal[row]),
        external=float(residuals.external[row]),
        leverage=float(residuals.leverage[row]),
        cook=float(residuals.cook[row]),
    )


def _pattern(pattern: AnglePattern) -> PatternPart:
    return PatternPart(
        joint=pattern.joint,
        angle_deg=np.round(pattern.angle_deg, 6).tolist(),
        mean_um=np.round(pattern.mean_um, 4).tolist(),
        count=pattern.count.tolist(),
        explained_um=pattern.explained_um,
        f_ratio=pattern.ratio,
        probability=pattern.probability,
    )


def _series(series: HarmonicSeries) -> HarmonicsPart:
    length = series.target == "length"
    factor = 1e3 if length else MDEG_PER_RAD
    return HarmonicsPart(
        target=series.target,
        source=series.source,
        unit="um" if length else "mdeg",
        absorbed_orders=list(series.absorbed),
        orders=[_harmonic(harmonic, factor) for harmonic in series.harmonics],
    )


def _harmonic(harmonic: Harmonic, factor: float) -> HarmonicPart:
    return HarmonicPart(
        order=harmonic.order,
        aliases=list(harmonic.aliases),
        amplitude=factor * harmonic.amplitude,
        u=factor * harmonic.u,
        explained_um=harmonic.explained_um,
        false_alarm_probability=harmonic.probability,
    )


def _nodes(nodes: NodeSpacing) -> NodesPart:
    best = nodes.by_prediction
    return NodesPart(
        commands_between_nodes_of_j1=nodes.between1,
        commands_between_nodes_of_j2=nodes.between2,
        best_aicc=nodes.by_aicc.name,
        best_bic=nodes.by_bic.name,
        best_prediction=None if best is None else best.name,
        grids=[GridPart.model_validate(grid) for grid in nodes.grids],
    )
