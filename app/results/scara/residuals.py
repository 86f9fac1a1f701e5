"""Means of the residuals per pose: what is common to the repeats of a pose is no scatter."""

from dataclasses import dataclass

import numpy as np

from catseye.app.results.residual_sign import measured_minus_predicted
from catseye.app.results.scara.result import Fit, Residuals
from catseye.calibration.core.types import Floats


@dataclass(frozen=True)
class PoseMeans:
    """Means over the repeats of each pose of one reflector, as columns of one length.

    Attributes:
        theta1_deg: J1.
        theta2_deg: J2.
        mean_um: mean residual, measured minus predicted.
        count: number of repeats.
    """

    theta1_deg: Floats
    theta2_deg: Floats
    mean_um: Floats
    count: Floats


def pose_means(residuals: Residuals, reflector: str) -> PoseMeans:
    """Return the means of one reflector."""
    own = np.array([name == reflector for name in residuals.reflector])
    angles = np.column_stack([residuals.theta1_deg, residuals.theta2_deg])[own]
    poses, group = np.unique(angles, axis=0, return_inverse=True)
    group = np.ravel(group)
    count = np.bincount(group).astype(np.float64)
    residual_um = measured_minus_predicted(np.array(residuals.residual_um)[own])
    mean = np.bincount(group, residual_um) / count
    return PoseMeans(poses[:, 0], poses[:, 1], mean, count)


@dataclass(frozen=True)
class Reference:
    """What residuals are compared with.

    Attributes:
        sigma_um: standard deviation of a residual that is expected.
        stated: it follows from the stated uncertainties, else from the fit itself.
        scatter_um: standard deviation of the repeats of a pose.
    """

    sigma_um: float
    stated: bool
    scatter_um: float


def reference(fit: Fit) -> Reference:
    """Return what the residuals of a fit are compared with.

    χ² / dof counts in squares of the stated uncertainty; systematic contributors are taken off before.
    """
    scatter_um = fit.sigma0_um if fit.lack_of_fit is None else fit.lack_of_fit.pure_um
    if not fit.chi2_reduced:
        return Reference(fit.sigma0_um, False, scatter_um)
    expected = fit.sigma0_um / float(np.sqrt(fit.chi2_reduced))
    return Reference(expected, True, scatter_um)
