"""Identification of a serial arm: from measurements at poses to parameters with their covariance."""

import math
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from catseye.calibration.core.arguments import require_one_of
from catseye.calibration.core.budget import Shared
from catseye.calibration.core.errors import ArgumentError, InsufficientPointsError, UnidentifiableError
from catseye.calibration.core.estimation import Estimate, estimate
from catseye.calibration.core.least_squares import factorise
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.arm import Known, SerialArm
from catseye.calibration.serial_arm.closed_form import Start, closed_form
from catseye.calibration.serial_arm.geometry import Commands, Geometry
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.model import ArmModel
from catseye.calibration.serial_arm.parameters import (
    BaseFrame,
    Parameter,
    base_parameters,
    compliance_parameters,
    distance_parameters,
    harmonic_parameters,
    link_parameters,
    map_parameters,
    orientation_parameters,
    reversal_parameters,
    target_parameters,
)
from catseye.calibration.serial_arm.redundancy import Choice, choose_basis

ModelName = Literal["frames", "geometric", "geometric+compliance", "maps"]
"""From the simplest to the richest; each has the parameters of those before it."""

MODELS: tuple[ModelName, ...] = get_args(ModelName)

HARMONIC_ORDERS = (1.0, 2.0)
"""Periods in a turn of a joint that the model with maps has."""

HARMONIC_U_DEG = 0.02
"""Standard deviation of their amplitudes among arms, where nobody says: strain wave gears have such errors."""

_FAR_WORSE = 30.0
"""A standard uncertainty so many times that of as many poses all over the ranges shows that poses are missing."""

_SCATTER_ROUNDS = 4
"""Scatter and estimate in turn: each round takes a tenth of what is left, as a rule."""

_LEAST_SCATTER = 1e-12
"""Share of the variance that rows without errors keep in a round."""

_TRIAL_POSES = 100
_TRIAL_SEED = 1


@dataclass(frozen=True)
class Calibration:
    """An arm as its measurements show it.

    Attributes:
        name: of the model.
        model: rows and estimated parameters.
        estimate: values and covariance of the estimated parameters.
        null_directions: names of parameters that say the same to measurements of this kind; the last is held.
    """

    name: ModelName
    model: ArmModel
    estimate: Estimate
    null_directions: tuple[tuple[str, ...], ...]

    @property
    def scale(self) -> float:
        """Scatter of the rows over what their weights, and the errors that they share, say."""
        fit = self.estimate.fit
        variance = fit.unit_weight_variance if fit.chi2_reduced is None else fit.chi2_reduced
        return math.sqrt(max(variance, _LEAST_SCATTER))

    @property
    def geometry(self) -> Geometry:
        """The arm with the estimated values."""
        return self.model.geometry(self.estimate.values)

    def places_mm(self, commands: Commands, target: int) -> Floats:
        """Return where a target is at poses, in the frame of the instrument, mm, shape (n, 3)."""
        geometry = self.geometry
        flange = geometry.frames(commands)[-1]
        return geometry.places_mm(flange, np.full(len(commands), target))

    def covariance_of_places(self, commands: Commands, target: int) -> Floats:
        """Return the covariances of `places_mm` from those of the parameters, mm², shape (n, 3, 3)."""
        moved = self.model.moved(self.estimate.values, commands, target)
        return np.asarray(moved @ self.estimate.covariance @ moved.transpose(0, 2, 1))


def parameters_of(
    arm: SerialArm, measurements: Measurements, name: ModelName, harmonic_u_deg: float = HARMONIC_U_DEG
) -> tuple[Parameter, ...]:
    """Return everything that a model has for measurements, redundant or not.

    Args:
        harmonic_u_deg: standard deviation that an amplitude of the maps has among arms.

    Raises:
        ArgumentError: there is no such model.
    """
    require_one_of(ModelName, name, "model")
    rank = MODELS.index(name)
    found = base_parameters() + target_parameters(arm, measurements.targets)
    found += orientation_parameters(arm, np.unique(measurements.orientations.target).tolist())
    found += distance_parameters(measurements.distances.anchors, measurements.distances.segments)
    if rank >= 1:
        found += link_parameters(arm)
    if rank >= 2:
        found += compliance_parameters(arm)
    if rank >= 3:
        both = bool(np.ptp(measurements.commands.approach))
        joints = measurements.commands.joints
        used = list(zip(joints.min(axis=0).tolist(), joints.max(axis=0).tolist(), strict=True))
        found += harmonic_parameters(arm, HARMONIC_ORDERS, harmonic_u_deg)
        found += map_parameters(arm, used, harmonic_u_deg, reversal=both)
        found += reversal_parameters(arm) if both else ()
    return tuple(_informed(one, arm.known.get(one.name)) for one in found)


def _informed(parameter: Parameter, known: Known | None) -> Parameter:
    """Return a parameter with what is known of it beforehand."""
    if known is None:
        return parameter
    if isinstance(parameter.role, BaseFrame):
        raise ArgumentError(
            f"{parameter.name} cannot be known beforehand: the base is where the measurements put it"
        )
    return replace(parameter, nominal=parameter.nominal if known.value is None else known.value, u=known.u)


def identify_arm(
    arm: SerialArm,
    measurements: Measurements,
    name: ModelName,
    start: Start | None = None,
    harmonic_u_deg: float = HARMONIC_U_DEG,
) -> Calibration:
    """Identify the parameters of a model.

    Args:
        harmonic_u_deg: standard deviation that an amplitude of the maps has among arms.
        start: about where the base and what has no nominal place are; found in closed form without one.

    Raises:
        InsufficientPointsError: there are fewer rows than parameters.
        UnidentifiableError: the poses do not show what other poses would; the parameters are named.
        ConvergenceError: the iteration does not settle.
    """
    begin = closed_form(arm, measurements) if start is None else start
    model = ArmModel(arm, begin.frame, parameters_of(arm, measurements, name, harmonic_u_deg), measurements)
    ideal = _ideal(model, model.start_values(begin))
    structure = choose_basis(arm.chain, model.chosen, ideal)
    fitted = replace(
        model,
        chosen=tuple(model.chosen[k] for k in structure.kept),
        held=tuple((model.chosen[k], float(model.start_values(begin)[k])) for k in structure.held),
        undetermined=_poses_wanted,
    )
    _require_rows(fitted)
    fitted, estimated = _estimated(fitted, fitted.start_values(begin))
    found = Calibration(name, fitted, estimated, structure.directions)
    _require_shown(found, ideal[:, structure.kept])
    return found


def _estimated(model: ArmModel, start: Floats) -> tuple[ArmModel, Estimate]:
    """Estimate; what is known beforehand is weighed against the scatter of the rows where they state none."""
    found = estimate(model, start)
    if model.stated or not model.known:
        return model, found
    for _ in range(_SCATTER_ROUNDS):
        variance = max(found.fit.unit_weight_variance, _LEAST_SCATTER)
        model = replace(model, scatter_mm=model.scatter_mm * math.sqrt(variance))
        found = estimate(model, found.values)
    return model, found


def estimated_again(found: Calibration, model: ArmModel) -> Calibration:
    """Return a calibration with other rows, or with other knowledge of the same parameters."""
    model, again = _estimated(model, found.estimate.values)
    return replace(found, model=model, estimate=again)


def refined(found: Calibration, common: tuple[Shared, ...]) -> Calibration:
    """Return a calibration with errors that rows have in common."""
    model = replace(found.model, common=common)
    return replace(found, model=model, estimate=estimate(model, found.estimate.values))


def tell_apart(model: ArmModel) -> Choice:
    """Return which parameters such measurements tell apart wherever the arm stands, about nominal values."""
    nominal = np.array([one.nominal for one in model.chosen])
    return choose_basis(model.arm.chain, model.chosen, _ideal(model, nominal))


def _ideal(model: ArmModel, values: Floats) -> Floats:
    """Return the derivatives of what measurements of this kind show wherever the arm stands, shape (m, p)."""
    joints = model.arm.chain.joints
    low, high = np.array([(joint.low, joint.high) for joint in joints]).T
    trial = np.random.default_rng(_TRIAL_SEED).uniform(low, high, (_TRIAL_POSES, len(joints)))
    sides = np.where(np.arange(_TRIAL_POSES) % 2, 1.0, -1.0)[:, None] * np.ones(len(joints))
    approach = sides if np.ptp(model.measurements.commands.approach) else np.ones_like(sides)
    everywhere = model.measurements.everywhere(Commands.of(model.arm, trial, approach))
    return replace(model, measurements=everywhere).jacobian(values)


def _require_shown(found: Calibration, ideal: Floats) -> None:
    """Refuse poses that leave a parameter far more uncertain than poses all over the ranges would.

    A rank hides that: deflections move every joint a little, and so show a little of everything.
    """
    model = found.model
    jacobian = model.jacobian(found.estimate.values)
    seen, could = (np.diag(factorise(one).covariance()) * len(one) for one in (jacobian, ideal))
    names = [one.name for one, far in zip(model.chosen, seen > _FAR_WORSE**2 * could, strict=True) if far]
    if names:
        raise UnidentifiableError(_poses_wanted([names]), [names])


def _require_rows(model: ArmModel) -> None:
    if model.rows <= len(model.chosen):
        raise InsufficientPointsError(
            f"{model.rows} rows for {len(model.chosen)} parameters: measure at more poses, or choose a simpler model "
            "(frames, geometric)"
        )


def _poses_wanted(directions: list[list[str]]) -> str:
    listed = "; ".join(", ".join(names) for names in directions)
    return (
        f"the poses do not tell these parameters apart: {listed}. Measure poses that move these joints through their "
        "ranges (catseye select-poses), or choose a simpler model"
    )
