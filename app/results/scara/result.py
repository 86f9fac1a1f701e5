"""Result JSON, version 1: an identified arm with its uncertainties."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from catseye.app.errors import UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.files.documents import LARGEST_RESULT_BYTES
from catseye.app.results.scara.scan_part import ScanPart
from catseye.app.results.uncertainty_part import UncertaintyPart
from catseye.calibration.core.fit_statistics import FitStatistics, RobustLoss
from catseye.calibration.scara.extension import Part, Source, Target, Term
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.layout import GAUGE
from catseye.drivers.roles.user_file import read_regular

Finite = Annotated[float, Field(allow_inf_nan=False)]
Uncertainty = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Length = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


class _Part(BaseModel):
    # Keys beyond version 1 are kept out of the way, not refused: results travel between versions.
    model_config = ConfigDict(frozen=True, extra="ignore")


class _Columns(_Part):
    """Columns of a table."""

    @model_validator(mode="after")
    def _equally_long(self) -> Self:
        lengths = {name: len(getattr(self, name)) for name in type(self).model_fields}
        if len(set(lengths.values())) > 1:
            raise ValueError(f"the columns differ in length: {lengths}")
        return self


class Estimate(_Part):
    """A value with its standard uncertainty (k = 1)."""

    value: Finite
    u: Uncertainty


class MapTable(_Columns):
    """A bidirectional map at its nodes."""

    node_deg: list[Finite]
    positive_mdeg: list[Finite]
    negative_mdeg: list[Finite]
    u_positive_mdeg: list[Uncertainty]
    u_negative_mdeg: list[Uncertainty]


class Place(_Part):
    """Where a reflector stands."""

    name: str
    x_mm: Estimate
    y_mm: Estimate


class DeadPath(_Part):
    """Beam length at a segment's zero."""

    reflector: str
    segment: int
    length_mm: Estimate


class LackOfFitPart(_Part):
    """Test against repeated poses."""

    systematic_um: float
    pure_um: float
    ratio: float
    expected_ratio: float
    probability: float
    probability_stated: float
    significant: bool
    explained: bool


class RobustPart(_Part):
    """What a robust loss made of the distances."""

    loss: Literal["huber", "soft-l1"]
    sigma_um: Finite
    half: Finite
    counted_little: int


class Fit(_Part):
    """Quality of the fit."""

    n_points: int
    n_parameters: int
    dof: int
    rms_um: float
    sigma0_um: float
    iterations: int
    rejected: list[str]
    null_directions: list[list[str]]
    chi2_reduced: float | None = None
    chi2_expected: float = 1.0
    chi2_probability: float | None = None
    variance_factor: float = 1.0
    lack_of_fit: LackOfFitPart | None = None
    robust: RobustPart | None = None


class Nominal(_Part):
    """Links that command positions are calculated with."""

    link1_mm: Length
    link2_mm: Length


class TermEstimate(_Part):
    """A function beyond the model with its coefficient, mdeg or µm."""

    target: Target
    source: Source
    part: Part
    order: int
    unit: Literal["mdeg", "um"]
    value: Finite
    u: Finite


class Covariance(_Part):
    """Covariance of the arm's parameters, mm and rad."""

    names: list[str]
    matrix: list[list[Finite]]


class Residuals(_Columns):
    """Residual (predicted minus measured) of each distance, as columns."""

    reflector: list[str]
    segment: list[int]
    theta1_deg: list[float]
    theta2_deg: list[float]
    direction1: list[int]
    direction2: list[int]
    residual_um: list[float]


class Provenance(_Part):
    """Where it comes from; whether of emulated devices is not known of a points file.

    `unverified` says what speaks against runs that were changed after their end and used all the same; None for none.
    """

    runs: list[str]
    software: str
    created: str
    simulated: bool | None = None
    unverified: list[str] | None = None


class Result(_Part):
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
    scan: ScanPart | None = None
    provenance: Provenance

    @property
    def has_maps(self) -> bool:
        """The model has a map of each joint."""
        return self.theta1_map is not None and self.theta2_map is not None


def result_of(
    identified: Identification,
    nominal: tuple[float, float],
    runs: Sequence[str],
    software: str,
    created: str,
    simulated: bool | None = None,
) -> Result:
    """Return an identification as a result.

    Args:
        identified: what the solver returned.
        nominal: nominal links, mm.
        runs: names of the runs or of the points file.
        software: name and version of the program.
        created: ISO 8601 UTC time.
        simulated: the distances are those of emulated devices; None when it is not known.
    """
    layout, u = identified.layout, identified.standard_uncertainty
    values = identified.parameters
    conventional = layout.model == "conventional"
    return Result(
        model=layout.model,
        gauge="theta1 map = 0 (the command angles of J1 fix the frame)" if conventional else GAUGE,
        link1_mm=Estimate(value=float(values[0]), u=float(u[0])),
        link2_mm=Estimate(value=float(values[1]), u=float(u[1])),
        theta20_mdeg=_mdeg(values[2], u[2]) if conventional else None,
        theta1_map=None if conventional else _table(identified, layout.nodes1_rad, layout.map1),
        theta2_map=None if conventional else _table(identified, layout.nodes2_rad, layout.map2),
        reflectors=_places(identified),
        dead_paths=_dead_paths(identified),
        fit=_fit(identified.fit, identified.rejected),
        extension=_extension(identified),
        nominal=Nominal(link1_mm=nominal[0], link2_mm=nominal[1]),
        covariance=Covariance(
            names=layout.names()[: layout.arm_size],
            matrix=identified.covariance[: layout.arm_size, : layout.arm_size].tolist(),
        ),
        residuals=_residuals(identified),
        provenance=Provenance(runs=list(runs), software=software, created=created, simulated=simulated),
    )


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
    try:
        result = Result.model_validate_json(read_regular(path, LARGEST_RESULT_BYTES).decode("utf-8-sig"))
    except FileNotFoundError as error:
        raise UsageError(f"{path}: there is no such file") from error
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise UsageError(
            f"{path}: cannot be read: it is not UTF-8 text, so no result of catseye identify"
        ) from error
    except ValidationError as error:
        faults = "; ".join(
            f"{'.'.join(str(part) for part in fault['loc']) or 'file'}: {fault['msg']}"
            for fault in error.errors()[:5]
        )
        raise UsageError(
            f"{path}: is no catseye-result/1 file as catseye identify writes it: {faults}"
        ) from error
    if "format" not in result.model_fields_set:
        raise UsageError(f'{path}: is no catseye-result/1 file: the key "format" is missing')
    return result


def _mdeg(value_rad: float, u_rad: float) -> Estimate:
    return Estimate(value=1e3 * math.degrees(value_rad), u=1e3 * math.degrees(u_rad))


def _extension(identified: Identification) -> list[TermEstimate] | None:
    layout = identified.layout
    if not layout.terms:
        return None
    values, u = identified.parameters[layout.extension], identified.standard_uncertainty[layout.extension]
    return [
        TermEstimate(
            target=term.target,
            source=term.source,
            part=term.part,
            order=term.order,
            unit="mdeg" if term.angular else "um",
            value=float(value) * term_unit(term),
            u=float(one_u) * term_unit(term),
        )
        for term, value, one_u in zip(layout.terms, values, u, strict=True)
    ]


def term_unit(term: Term) -> float:
    """Return what makes mdeg or µm of a term's coefficient in rad or mm."""
    return 1e3 * math.degrees(1.0) if term.angular else 1e3


def _table(
    identified: Identification, nodes_rad: np.ndarray[tuple[int, ...], np.dtype[np.float64]], part: slice
) -> MapTable:
    values = 1e3 * np.rad2deg(identified.parameters[part])
    u = 1e3 * np.rad2deg(identified.standard_uncertainty[part])
    half = nodes_rad.size
    return MapTable(
        node_deg=np.round(np.rad2deg(nodes_rad), 9).tolist(),
        positive_mdeg=values[:half].tolist(),
        negative_mdeg=values[half:].tolist(),
        u_positive_mdeg=u[:half].tolist(),
        u_negative_mdeg=u[half:].tolist(),
    )


def _places(identified: Identification) -> list[Place]:
    layout = identified.layout
    values = identified.parameters[layout.reflectors].reshape(-1, 2).tolist()
    u = identified.standard_uncertainty[layout.reflectors].reshape(-1, 2).tolist()
    return [
        Place(name=name, x_mm=Estimate(value=xy[0], u=uxy[0]), y_mm=Estimate(value=xy[1], u=uxy[1]))
        for name, xy, uxy in zip(layout.reflector_names, values, u, strict=True)
    ]


def _dead_paths(identified: Identification) -> list[DeadPath]:
    layout = identified.layout
    values = identified.parameters[layout.dead_path].tolist()
    u = identified.standard_uncertainty[layout.dead_path].tolist()
    return [
        DeadPath(reflector=name, segment=segment, length_mm=Estimate(value=value, u=uncertainty))
        for (name, segment), value, uncertainty in zip(layout.dead_paths, values, u, strict=True)
    ]


def _fit(fit: FitStatistics, rejected: list[str]) -> Fit:
    lack = fit.lack_of_fit
    return Fit(
        n_points=fit.n_points,
        n_parameters=fit.n_parameters,
        dof=fit.dof,
        rms_um=fit.rms_um,
        sigma0_um=fit.sigma0_um,
        iterations=fit.iterations,
        rejected=rejected,
        null_directions=[],
        chi2_reduced=fit.chi2_reduced,
        chi2_expected=fit.chi2_expected,
        chi2_probability=fit.chi2_probability,
        variance_factor=fit.variance_factor,
        lack_of_fit=None
        if lack is None
        else LackOfFitPart(
            systematic_um=lack.systematic_um,
            pure_um=lack.pure_um,
            ratio=lack.ratio,
            expected_ratio=lack.expected_ratio,
            probability=lack.probability,
            probability_stated=lack.probability_stated,
            significant=lack.significant,
            explained=lack.explained,
        ),
        robust=None if fit.loss is None else _robust(fit.loss),
    )


def _robust(loss: RobustLoss) -> RobustPart:
    return RobustPart.model_validate(
        {
            "loss": loss.name,
            "sigma_um": loss.sigma_um,
            "half": loss.half,
            "counted_little": loss.counted_little,
        }
    )


def _residuals(identified: Identification) -> Residuals:
    points, commands = identified.points, identified.points.commands
    return Residuals(
        reflector=[points.reflector_names[i] for i in points.reflector],
        segment=[points.dead_paths[i][1] for i in points.dead_path],
        theta1_deg=np.round(np.rad2deg(commands.theta1_rad), 9).tolist(),
        theta2_deg=np.round(np.rad2deg(commands.theta2_rad), 9).tolist(),
        direction1=commands.direction1.tolist(),
        direction2=commands.direction2.tolist(),
        residual_um=np.round(1e3 * identified.residuals_mm, 6).tolist(),
    )
