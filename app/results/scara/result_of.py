"""From an identification to the content of a result file."""

import math
from collections.abc import Sequence

import numpy as np

from catseye.app.results.provenance import Provenance
from catseye.app.results.scara.result import (
    Covariance,
    DeadPath,
    Estimate,
    Fit,
    LackOfFitPart,
    MapTable,
    Nominal,
    Place,
    Residuals,
    Result,
    RobustPart,
    TermEstimate,
    term_unit,
)
from catseye.calibration.core.fit_statistics import FitStatistics
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.layout import GAUGE


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
        nominal: nominal links, mm.
        runs: names of the runs or of the points file.
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
        fit=_fit(identified.fit, identified.points.returns, identified.rejected),
        extension=_extension(identified),
        nominal=Nominal(link1_mm=nominal[0], link2_mm=nominal[1]),
        covariance=Covariance(
            names=layout.names()[: layout.arm_size],
            matrix=identified.covariance[: layout.arm_size, : layout.arm_size].tolist(),
        ),
        residuals=_residuals(identified),
        provenance=Provenance(runs=list(runs), software=software, created=created, simulated=simulated),
    )


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


def _table(identified: Identification, nodes_rad: Floats, part: slice) -> MapTable:
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


def _fit(fit: FitStatistics, returns: int | None, rejected: list[str]) -> Fit:
    lack = fit.lack_of_fit
    return Fit(
        n_points=fit.n_points,
        n_returns=returns,
        n_parameters=fit.n_parameters,
        dof=fit.dof,
        rms_um=fit.rms_um,
        sigma0_um=fit.sigma0_um,
        iterations=fit.iterations,
        rejected=rejected,
        null_directions=[],
        chi2_reduced=fit.chi2_reduced,
        chi2_probability=fit.chi2_probability,
        variance_ratio=fit.variance_ratio,
        row_variance_mm2=fit.row_variance_mm2,
        lack_of_fit=None if lack is None else LackOfFitPart.model_validate(lack),
        robust=None if fit.robust is None else RobustPart.model_validate(fit.robust),
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
