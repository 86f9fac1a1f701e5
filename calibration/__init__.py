"""Pure mathematics: kinematics, error maps, identification, uncertainty, diagnostics, design. No I/O, no clock.

The names below are the public interface (docs/api.md). Each is imported when it is first asked for: the command line
and the emulators start without the numerical libraries that they do not need.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from catseye.calibration.comparison import Comparison, compare
    from catseye.calibration.compensation import Compensation, compensate
    from catseye.calibration.design.criteria import Criterion
    from catseye.calibration.design.exchange import Pool, exchange, greedy_start
    from catseye.calibration.design.information import Study
    from catseye.calibration.design.sight import Rules, Way, sight_of
    from catseye.calibration.diagnostics.diagnosis import Diagnosis, diagnose
    from catseye.calibration.diagnostics.problem import Problem
    from catseye.calibration.diagnostics.rejection import reject
    from catseye.calibration.diagnostics.robust import robust_fit
    from catseye.calibration.error_map import BidirectionalMap
    from catseye.calibration.errors import CalibrationError
    from catseye.calibration.extension import Term, crosstalk, j4_map, periodic, thermal_drift
    from catseye.calibration.identification import Identification, IdentifiedArm, identify
    from catseye.calibration.kinematics.planar import forward, inverse
    from catseye.calibration.points import Commands, Points
    from catseye.calibration.prediction import Prediction, predict
    from catseye.calibration.scans.scan_identification import identify_scan
    from catseye.calibration.scans.source import SlicedPoints
    from catseye.calibration.standards.iso230_2 import positioning, systematic_of_map
    from catseye.calibration.uncertainty.arm_draws import draw_estimates
    from catseye.calibration.uncertainty.budget import Budget, Contributor
    from catseye.calibration.uncertainty.contributions import contributions
    from catseye.calibration.uncertainty.coverage import shortest_interval, symmetric_interval
    from catseye.calibration.uncertainty.gum import coverage_factor

__all__ = [
    "BidirectionalMap",
    "Budget",
    "CalibrationError",
    "Commands",
    "Comparison",
    "Compensation",
    "Contributor",
    "Criterion",
    "Diagnosis",
    "Identification",
    "IdentifiedArm",
    "Points",
    "Pool",
    "Prediction",
    "Problem",
    "Rules",
    "SlicedPoints",
    "Study",
    "Term",
    "Way",
    "compare",
    "compensate",
    "contributions",
    "coverage_factor",
    "crosstalk",
    "diagnose",
    "draw_estimates",
    "exchange",
    "forward",
    "greedy_start",
    "identify",
    "identify_scan",
    "inverse",
    "j4_map",
    "periodic",
    "positioning",
    "predict",
    "reject",
    "robust_fit",
    "shortest_interval",
    "sight_of",
    "symmetric_interval",
    "systematic_of_map",
    "thermal_drift",
]

_HOMES = {
    "BidirectionalMap": "error_map",
    "Budget": "uncertainty.budget",
    "CalibrationError": "errors",
    "Commands": "points",
    "Comparison": "comparison",
    "Compensation": "compensation",
    "Contributor": "uncertainty.budget",
    "Criterion": "design.criteria",
    "Diagnosis": "diagnostics.diagnosis",
    "Identification": "identification",
    "IdentifiedArm": "identification",
    "Points": "points",
    "Pool": "design.exchange",
    "Prediction": "prediction",
    "Problem": "diagnostics.problem",
    "Rules": "design.sight",
    "SlicedPoints": "scans.source",
    "Study": "design.information",
    "Term": "extension",
    "Way": "design.sight",
    "compare": "comparison",
    "compensate": "compensation",
    "contributions": "uncertainty.contributions",
    "coverage_factor": "uncertainty.gum",
    "crosstalk": "extension",
    "diagnose": "diagnostics.diagnosis",
    "draw_estimates": "uncertainty.arm_draws",
    "exchange": "design.exchange",
    "forward": "kinematics",
    "greedy_start": "design.exchange",
    "identify": "identification",
    "identify_scan": "scans.scan_identification",
    "inverse": "kinematics",
    "j4_map": "extension",
    "periodic": "extension",
    "positioning": "standards.iso230_2",
    "predict": "prediction",
    "reject": "diagnostics.rejection",
    "robust_fit": "diagnostics.robust",
    "shortest_interval": "uncertainty.coverage",
    "sight_of": "design.sight",
    "symmetric_interval": "uncertainty.coverage",
    "systematic_of_map": "standards.iso230_2",
    "thermal_drift": "extension",
}
"""Module of each public name."""


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
