"""Pure mathematics: kinematics, error maps, identification, uncertainty, diagnostics, design. No I/O, no clock.

The names below are the public interface (docs/api.md). Each is imported when it is first asked for: the command line
and the emulators start without the numerical libraries that they do not need.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from catseye.calibration.core.coverage import coverage_factor, shortest_interval, symmetric_interval
    from catseye.calibration.core.design.exchange import Pool, exchange, greedy_start
    from catseye.calibration.core.errors import CalibrationError
    from catseye.calibration.scara.budget import Budget, Contributor
    from catseye.calibration.scara.comparison import Comparison, compare
    from catseye.calibration.scara.compensation import Compensation, compensate
    from catseye.calibration.scara.design.criterion import Criterion
    from catseye.calibration.scara.design.sight import Rules, Way, sight_of
    from catseye.calibration.scara.design.study import Study
    from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis, diagnose
    from catseye.calibration.scara.diagnostics.problem import Problem
    from catseye.calibration.scara.diagnostics.rejection import reject
    from catseye.calibration.scara.diagnostics.robust import robust_fit
    from catseye.calibration.scara.error_map import BidirectionalMap
    from catseye.calibration.scara.extension import Term, crosstalk, j4_map, periodic, thermal_drift
    from catseye.calibration.scara.identification import Identification, IdentifiedArm, identify
    from catseye.calibration.scara.planar import forward, inverse
    from catseye.calibration.scara.points import Commands, Points
    from catseye.calibration.scara.prediction import Prediction, predict
    from catseye.calibration.scara.scans.scan_identification import identify_scan
    from catseye.calibration.scara.scans.source import SlicedPoints
    from catseye.calibration.scara.uncertainty import contributions, draw_estimates
    from catseye.calibration.standards.iso230_2 import positioning, systematic_of_map

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
    "BidirectionalMap": "scara.error_map",
    "Budget": "scara.budget",
    "CalibrationError": "core.errors",
    "Commands": "scara.points",
    "Comparison": "scara.comparison",
    "Compensation": "scara.compensation",
    "Contributor": "scara.budget",
    "Criterion": "scara.design.criterion",
    "Diagnosis": "scara.diagnostics.diagnosis",
    "Identification": "scara.identification",
    "IdentifiedArm": "scara.identification",
    "Points": "scara.points",
    "Pool": "core.design.exchange",
    "Prediction": "scara.prediction",
    "Problem": "scara.diagnostics.problem",
    "Rules": "scara.design.sight",
    "SlicedPoints": "scara.scans.source",
    "Study": "scara.design.study",
    "Term": "scara.extension",
    "Way": "scara.design.sight",
    "compare": "scara.comparison",
    "compensate": "scara.compensation",
    "contributions": "scara.uncertainty",
    "coverage_factor": "core.coverage",
    "crosstalk": "scara.extension",
    "diagnose": "scara.diagnostics.diagnosis",
    "draw_estimates": "scara.uncertainty",
    "exchange": "core.design.exchange",
    "forward": "scara.planar",
    "greedy_start": "core.design.exchange",
    "identify": "scara.identification",
    "identify_scan": "scara.scans.scan_identification",
    "inverse": "scara.planar",
    "j4_map": "scara.extension",
    "periodic": "scara.extension",
    "positioning": "standards.iso230_2",
    "predict": "scara.prediction",
    "reject": "scara.diagnostics.rejection",
    "robust_fit": "scara.diagnostics.robust",
    "shortest_interval": "core.coverage",
    "sight_of": "scara.design.sight",
    "symmetric_interval": "core.coverage",
    "systematic_of_map": "standards.iso230_2",
    "thermal_drift": "scara.extension",
}
"""Module of each public name."""


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
