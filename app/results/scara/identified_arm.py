"""A result file's arm, ready for prediction and compensation."""

import math

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.protocol.banners import unverified_text
from catseye.app.results.scara.budget_text import budget_remarks
from catseye.app.results.scara.result import Covariance, Result, term_unit
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.extension import Term
from catseye.calibration.scara.identification import IdentifiedArm, TakenUp
from catseye.calibration.scara.layout import Layout

CATALOGUE_MM = (325.0, 225.0)
"""Links of an RH-3FRH5515, the robot that the program is made for."""

_SAME_ROBOT_MM = 2.0
"""Identified links are nearer to those of their catalogue than this."""

_SAME_ROBOT_SHARE = 0.1
"""Links of one robot in one unit differ by far less than this: by tenths of a millimetre."""

_ROUNDING = 1e-9
"""Share of the largest covariance by which rounding may spoil symmetry and variances that are zero."""

_MDEG = 1e-3 * math.pi / 180.0


def arm_of(result: Result) -> IdentifiedArm:
    """Return a result's arm; without a covariance its uncertainties are taken as uncorrelated.

    Raises:
        UsageError: the result lacks the maps or the offset of its model, or its covariance has another size.
    """
    layout = _layout(result)
    values, u = _estimates(result)
    if values.size != layout.arm_size:
        raise UsageError(f"the result holds {values.size} parameters of an arm that has {layout.arm_size}")
    _require_one_robot(result)
    budget = None if result.budget is None else result.budget.everything
    if result.covariance is None:
        return IdentifiedArm(layout, values, np.diag(u**2), budget)
    covariance = _covariance(result.covariance, layout)
    return IdentifiedArm(
        layout, values, covariance, budget, _taken_up(result.covariance, budget, values.size)
    )


def _taken_up(part: Covariance, budget: Budget | None, size: int) -> TakenUp:
    """Return what the parameters have taken up of contributors.

    Raises:
        UsageError: it belongs to another arm or budget.
    """
    if budget is None:
        return {}
    found: dict[Contributor, Floats] = {}
    for place, one in enumerate(part.taken_up or []):
        name = f"covariance.taken_up[{place}] of the result"
        if not 0 <= one.contributor < len(budget.contributors):
            raise UsageError(f"{name} belongs to no contributor of its error budget; identify again")
        contributor = budget.contributors[one.contributor]
        if contributor not in budget.repeating or contributor in found:
            raise UsageError(
                f"{name} is of {contributor.name}, which does not come again or stands there twice; identify again"
            )
        if [len(row) for row in one.matrix] != [contributor.sources] * size:
            raise UsageError(
                f"{name}, of {contributor.name}, has to be {size} rows of {contributor.sources} numbers; "
                "identify again"
            )
        found[contributor] = np.array(one.matrix, dtype=np.float64)
    return found


def _require_one_robot(result: Result) -> None:
    if result.nominal is None:
        return
    for name, found, nominal in (
        ("link1_mm", result.link1_mm.value, result.nominal.link1_mm),
        ("link2_mm", result.link2_mm.value, result.nominal.link2_mm),
    ):
        if abs(found / nominal - 1.0) > _SAME_ROBOT_SHARE:
            raise UsageError(
                f"{name} of the result is {found:g} and nominal.{name} {nominal:g}: they are not of one arm in mm; "
                "identify again with the arm's own links in the cell file"
            )


def _covariance(part: Covariance, layout: Layout) -> Floats:
    """Return the covariance of the arm's parameters.

    Raises:
        UsageError: it is another arm's, or no covariance.
    """
    names = layout.names()[: layout.arm_size]
    if part.names != names or [len(row) for row in part.matrix] != [len(names)] * len(names):
        raise UsageError(
            f"the result's covariance is not that of its {len(names)} parameters of the arm, in their order; "
            "identify again"
        )
    matrix = np.array(part.matrix, dtype=np.float64)
    rounding = _ROUNDING * float(np.abs(matrix).max())
    if np.abs(matrix - matrix.T).max() > rounding or np.linalg.eigvalsh(matrix)[0] < -rounding:
        raise UsageError(
            "the result's covariance is none: it is not symmetric, or some variances are negative; identify again"
        )
    return matrix


def arm_remarks(result: Result) -> list[str]:
    """Return what a reader of predictions from this result has to know: what it does not state."""
    remarks = unverified_texts(result)
    remarks += [remark] if (remark := nominal_of(result)[1]) else []
    remarks += [] if result.budget is None else budget_remarks(result.budget)
    if result.covariance is None:
        remarks.append(
            "the result holds no covariance: its standard uncertainties are taken as uncorrelated, which makes those "
            "of positions too large as a rule"
        )
    if result.budget is None:
        remarks.append(
            "the result holds no error budget: uncertainties of positions are those of its parameters alone, without "
            "what lies between nodes, the arm's repeatability and its radial error motions"
        )
    targets = [term for term in result.extension or [] if term.source == "elapsed"]
    if targets:
        remarks.append("the links grew over the measurement: they are taken as in its middle")
    return remarks


def unverified_texts(result: Result) -> list[str]:
    """Return what speaks against changed runs that the result was made of all the same."""
    return list(map(unverified_text, result.provenance.unverified or ()))


def nominal_of(result: Result) -> tuple[tuple[float, float], str]:
    """Return the links that command positions are calculated with, mm, and a warning if the result does not.

    Raises:
        UsageError: the result does not state them and its arm is none that the program knows.
    """
    if result.nominal is not None:
        return (result.nominal.link1_mm, result.nominal.link2_mm), ""
    found = (result.link1_mm.value, result.link2_mm.value)
    if max(abs(a - b) for a, b in zip(found, CATALOGUE_MM, strict=True)) > _SAME_ROBOT_MM:
        raise UsageError(
            f'the result does not state the nominal links (key "nominal"), and {found[0]:g} and {found[1]:g} mm '
            "are not those of an RH-3FRH5515: identify again, or add nominal.link1_mm and nominal.link2_mm"
        )
    return CATALOGUE_MM, "the result does not state the nominal links: 325 and 225 mm (RH-3FRH5515) are taken"


def _layout(result: Result) -> Layout:
    terms = tuple(Term(term.target, term.source, term.part, term.order) for term in result.extension or [])
    if result.model == "conventional":
        if result.theta20_mdeg is None:
            raise UsageError("the result is of the conventional model but holds no theta20_mdeg")
        return Layout("conventional", np.zeros(0), np.zeros(0), (), (), terms)
    if result.theta1_map is None or result.theta2_map is None:
        raise UsageError("the result is an error map but holds no theta1_map or no theta2_map")
    for name, table in (("theta1_map", result.theta1_map), ("theta2_map", result.theta2_map)):
        if not table.node_deg or np.any(np.diff(table.node_deg) <= 0.0):
            raise UsageError(f"{name}.node_deg of the result has to hold nodes that increase strictly")
    nodes1, nodes2 = (np.deg2rad(table.node_deg) for table in (result.theta1_map, result.theta2_map))
    return Layout("error-map", nodes1, nodes2, (), (), terms)


def _estimates(result: Result) -> tuple[Floats, Floats]:
    """Return values and standard uncertainties in the order of the parameter vector, mm and rad."""
    values, u = [result.link1_mm.value, result.link2_mm.value], [result.link1_mm.u, result.link2_mm.u]
    conventional = result.model == "conventional"
    if conventional and result.theta20_mdeg is not None:
        values.append(result.theta20_mdeg.value * _MDEG)
        u.append(result.theta20_mdeg.u * _MDEG)
    for table in (result.theta1_map, result.theta2_map):
        if table is not None and not conventional:
            values += [value * _MDEG for value in (*table.positive_mdeg, *table.negative_mdeg)]
            u += [value * _MDEG for value in (*table.u_positive_mdeg, *table.u_negative_mdeg)]
    for term in result.extension or []:
        unit = term_unit(Term(term.target, term.source, term.part, term.order))
        values.append(term.value / unit)
        u.append(term.u / unit)
    return np.array(values), np.array(u)
