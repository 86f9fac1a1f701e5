"""A diagnosis in plain sentences."""

from collections.abc import Sequence

import numpy as np

from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import MDEG_PER_RAD, listed
from catseye.app.results.scara.diagnosis import coefficients, outlying
from catseye.app.results.scara.fit_text import distances_text
from catseye.app.results.scara.names import ANGLES, VARYING
from catseye.calibration.core.cross_validation import CrossValidation
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.calibration.scara.diagnostics.drift import Change
from catseye.calibration.scara.diagnostics.harmonics import Harmonic, HarmonicSeries
from catseye.calibration.scara.diagnostics.nested_models import (
    CONVENTIONAL,
    ERROR_MAP,
    TOGETHER,
    ComparedModel,
)
from catseye.calibration.scara.diagnostics.node_spacing import Grid, NodeSpacing
from catseye.procedures.kit.expanded import expanded_text


def findings(diagnosis: Diagnosis) -> list[Statement]:
    """Return what the diagnosis says, the fit first."""
    return [
        _fit(diagnosis),
        _models(diagnosis.models),
        *_single_distances(diagnosis),
        *_changes(diagnosis.changes),
        *_patterns(diagnosis),
        *[_harmonics(harmonic) for harmonic in diagnosis.harmonics],
        *[_prediction(one) for one in (diagnosis.reflectors, diagnosis.sweeps, diagnosis.segments) if one],
        *_nodes(diagnosis.nodes),
    ]


def _fit(diagnosis: Diagnosis) -> Statement:
    fit = diagnosis.identified.fit
    distances = distances_text(fit.n_points, diagnosis.identified.points.returns)
    text = f"The error map leaves {fit.rms_um:.1f} µm rms in {distances}"
    if fit.chi2_reduced is None or diagnosis.misfit is None:
        return Statement(Sign.NEUTRAL, f"{text}; no uncertainty is stated that this could be compared with.")
    agrees = diagnosis.misfit >= SIGNIFICANCE
    words = "agrees with" if agrees else "exceeds"
    figures = f"χ²/dof = {fit.chi2_reduced:.2f}"
    return Statement(
        Sign.GOOD if agrees else Sign.BAD, f"{text}; that {words} the stated uncertainties ({figures})."
    )


def _models(models: Sequence[ComparedModel]) -> Statement:
    error_map = next(model for model in models if model.name == ERROR_MAP)
    parts = [_error_map(error_map)]
    extensions = [model for model in models if model.name not in {CONVENTIONAL, ERROR_MAP, TOGETHER}]
    parts += [_extension(extension) for extension in extensions]
    beyond = any(extension.significant for extension in extensions)
    return Statement(Sign.BAD if beyond else Sign.GOOD, "; ".join(parts) + ".")


def _error_map(model: ComparedModel) -> str:
    if model.significant:
        return f"The error map explains {model.explained_um:.1f} µm that the conventional model leaves"
    return "The error map explains nothing beyond the conventional model"


def _extension(model: ComparedModel) -> str:
    if model.refused:
        return f"{model.name} cannot be identified from these distances"
    if model.as_stated:
        return f"{model.name} no larger than the stated errors ({_clearest(model)})"
    if not model.significant:
        return f"no {model.name} ({_clearest(model)})"
    return f"{model.name} adds {model.explained_um:.1f} µm, significant"


def _clearest(model: ComparedModel) -> str:
    """Return the clearest coefficient with its uncertainty."""
    place = int(np.argmax(np.abs(model.coefficients) / model.u))
    return _coefficient_text(model, place)


def _coefficient_text(model: ComparedModel, place: int) -> str:
    """Return a coefficient of a model with its name, unit and expanded uncertainty."""
    found = coefficients(model)[place]
    return f"{found.name}: {expanded_text(found.value, found.u, 2)} {found.unit} (k = 2)"


def distance_text(diagnosis: Diagnosis, row: int) -> str:
    """Return which distance a row is."""
    points = diagnosis.identified.points
    commands = points.commands
    name, segment = points.dead_paths[int(points.dead_path[row])]
    signs = "".join("+" if one > 0 else "−" for one in (commands.direction1[row], commands.direction2[row]))
    return (
        f"row {row + 1} (reflector {name}, segment {segment}, θ1 {np.rad2deg(commands.theta1_rad[row]):.6g}°, "
        f"θ2 {np.rad2deg(commands.theta2_rad[row]):.6g}°, approach {signs})"
    )


def _single_distances(diagnosis: Diagnosis) -> list[Statement]:
    external: Floats = np.nan_to_num(diagnosis.residuals.external)
    far, limit = outlying(diagnosis), diagnosis.outlier_limit
    if not far:
        largest = float(np.abs(external).max())
        return [
            Statement(
                Sign.GOOD,
                f"No distance stands out: the largest studentised residual is {largest:.1f}, limit {limit:.1f}.",
            )
        ]
    listed = "; ".join(f"{distance_text(diagnosis, row)}: {abs(external[row]):.1f}" for row in far[:5])
    more = f" and {len(far) - 5} more" if len(far) > 5 else ""
    return [
        Statement(
            Sign.BAD,
            f"{len(far)} of {external.size} distances stand out (studentised residual beyond {limit:.1f}): {listed}"
            f"{more}. catseye identify --reject {limit:.1f} leaves such distances out and says which.",
        )
    ]


def _changes(changes: Sequence[Change]) -> list[Statement]:
    found = [change for change in changes if change.significant]
    if found:
        return [Statement(Sign.BAD, change_text(one)) for one in found]
    if not changes:
        return [Statement(Sign.NEUTRAL, "No segment is long enough to determine a drift.")]
    largest = max(changes, key=lambda one: abs(one.size_um) / one.u_um)
    size = expanded_text(largest.size_um, largest.u_um, 1, signed=True)
    text = (
        f"No drift and no jump: the clearest is {size} µm (k = 2) over segment {largest.segment} of reflector "
        f"{largest.reflector}."
    )
    return [Statement(Sign.GOOD, text)]


def change_text(change: Change) -> str:
    """Return a change in words."""
    where = f"segment {change.segment} of reflector {change.reflector}"
    size = f"{expanded_text(change.size_um, change.u_um, 1, signed=True)} µm (k = 2)"
    if change.kind == "drift":
        return f"Drift: over {where} ({change.rows} distances) the measured distance grows by {size}."
    return (
        f"Jump: in {where} the measured distance steps by {size} at its distance {change.within} (row {change.row}): "
        "the counter slipped, or reflector or arm moved. Give what follows a segment of its own, or measure it again."
    )


def _patterns(diagnosis: Diagnosis) -> list[Statement]:
    found = [pattern for pattern in diagnosis.patterns if pattern.significant]
    if not found:
        return [Statement(Sign.GOOD, "No pattern of the residuals along θ1, θ2 or θ4.")]
    parts = ", ".join(f"{one.explained_um:.1f} µm along θ{one.joint}" for one in found)
    return [Statement(Sign.BAD, f"Residuals follow the joints' angles: {parts}.")]


def _harmonics(series: HarmonicSeries) -> Statement:
    what = f"{VARYING[series.target]} against {ANGLES[series.source]}"
    if not series.harmonics:
        return Statement(
            Sign.NEUTRAL,
            f"Harmonics, {what}: nothing can be said, the map takes up every order at these commands; measure "
            "between the nodes.",
        )
    found = [harmonic for harmonic in series.harmonics if harmonic.significant]
    if not found:
        highest = max(harmonic.order for harmonic in series.harmonics)
        return Statement(
            Sign.GOOD, f"Harmonics, {what}: none left among orders up to {highest}{_aliases(series)}."
        )
    ranked = sorted(found, key=lambda one: -one.explained_um)
    listed = ", ".join(harmonic_text(one) for one in ranked[:4])
    more = f" and {len(found) - 4} more" if len(found) > 4 else ""
    return Statement(Sign.BAD, f"Harmonics, {what}: {listed}{more}.")


def harmonic_text(harmonic: Harmonic) -> str:
    """Return an order with its amplitude."""
    factor, unit = (1e3, "µm") if harmonic.target == "length" else (MDEG_PER_RAD, "mdeg")
    alias = f" (or {', '.join(str(order) for order in harmonic.aliases[:3])}, …)" if harmonic.aliases else ""
    known = expanded_text(factor * harmonic.amplitude, factor * harmonic.u, 2)
    return f"order {harmonic.order}{alias}: {known} {unit} (k = 2)"


def _aliases(series: HarmonicSeries) -> str:
    aliased = [harmonic for harmonic in series.harmonics if harmonic.aliases]
    if not aliased:
        return ""
    one = aliased[0]
    listed = ", ".join(str(order) for order in one.aliases[:3])
    return f" (higher ones look alike at these commands: {one.order} is also {listed}, …)"


def _prediction(validation: CrossValidation) -> Statement:
    lost = [fold.name for fold in validation.folds if not fold.identified or fold.weak]
    open_text = f" Poorly or not determined without it: {listed(lost)}." if lost else ""
    if not np.isfinite(validation.predicted_um):
        return Statement(
            Sign.NEUTRAL, f"Leave one {validation.way} out: the others do not determine the model."
        )
    text = (
        f"Leave one {validation.way} out: the others predict it to {validation.predicted_um:.1f} µm rms, in the fit "
        f"the same distances have {validation.in_sample_um:.1f} µm; expected {validation.expected_um:.1f} µm"
    )
    failing = [
        f"{fold.name} ({fold.predicted_um:.1f} µm, expected {fold.expected_um:.1f})"
        for fold in validation.folds
        if fold.fails
    ]
    if failing:
        return Statement(Sign.BAD, f"{text}. Worse than expected: {listed(failing)}.{open_text}")
    return Statement(Sign.GOOD, f"{text}.{open_text}")


def _nodes(nodes: NodeSpacing) -> list[Statement]:
    present = nodes.grids[0]
    chosen: list[tuple[str, Grid | None]] = [
        ("AICc", nodes.by_aicc),
        ("BIC", nodes.by_bic),
        ("prediction of left-out sweeps", nodes.by_prediction),
    ]
    others = {name: grid for name, grid in chosen if grid is not None and grid is not present}
    if not others:
        text = "Keep the nodes: every other grid that was tried is worse by AICc, BIC and prediction."
        found = [Statement(Sign.GOOD, text)]
    elif len({grid.name for _, grid in chosen if grid is not None}) == 1:
        found = [
            Statement(
                Sign.BAD, f"Take other nodes: {nodes.by_aicc.name} is better by AICc, BIC and prediction."
            )
        ]
    else:
        listed = "; ".join(f"{name}: {grid.name}" for name, grid in chosen if grid is not None)
        found = [
            Statement(
                Sign.NEUTRAL,
                f"The criteria disagree about the nodes, which says that little depends on it: {listed}.",
            )
        ]
    unseen = [f"J{joint}" for joint, seen in ((1, nodes.between1), (2, nodes.between2)) if not seen]
    if unseen:
        found.append(
            Statement(
                Sign.NEUTRAL,
                f"Whether nodes of {' and '.join(unseen)} should be closer is not known: there are too few "
                "commands between them.",
            )
        )
    return found
