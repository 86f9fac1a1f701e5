"""Pure mathematics: kinematics, error maps, identification, uncertainty, diagnostics, design. No I/O, no clock.

The names below are the public interface (docs/api.md). Each is imported when it is first asked for: the command line
and the emulators start without the numerical libraries that they do not need.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from catseye.calibration.core.coverage import coverage_factor as coverage_factor
    from catseye.calibration.core.coverage import shortest_interval as shortest_interval
    from catseye.calibration.core.coverage import symmetric_interval as symmetric_interval
    from catseye.calibration.core.design.exchange import Pool as Pool
    from catseye.calibration.core.design.exchange import exchange as exchange
    from catseye.calibration.core.design.exchange import greedy_start as greedy_start
    from catseye.calibration.core.errors import CalibrationError as CalibrationError
    from catseye.calibration.kinematics.chain import Chain as Chain
    from catseye.calibration.kinematics.chain import Joint as Joint
    from catseye.calibration.kinematics.gravity import Load as Load
    from catseye.calibration.kinematics.gravity import gravity_torques as gravity_torques
    from catseye.calibration.kinematics.gravity import potential_energy as potential_energy
    from catseye.calibration.kinematics.inverse import inverse_kinematics as inverse_kinematics
    from catseye.calibration.kinematics.jacobian import jacobian as jacobian
    from catseye.calibration.kinematics.rotations import angles_of as angles_of
    from catseye.calibration.kinematics.rotations import pose_of as pose_of
    from catseye.calibration.resolution.alignment import align as align
    from catseye.calibration.resolution.backlash import backlash as backlash
    from catseye.calibration.resolution.cartesian_steps import StepSeries as StepSeries
    from catseye.calibration.resolution.decaying import decaying_test as decaying_test
    from catseye.calibration.resolution.iso import iso_amplitude as iso_amplitude
    from catseye.calibration.resolution.iso import iso_test as iso_test
    from catseye.calibration.resolution.joint_model import JointModel as JointModel
    from catseye.calibration.resolution.joint_model import table_of as table_of
    from catseye.calibration.resolution.measured_steps import MeasuredSteps as MeasuredSteps
    from catseye.calibration.resolution.moves import moves_of as moves_of
    from catseye.calibration.resolution.optics import AngularOptics as AngularOptics
    from catseye.calibration.resolution.optics import LinearOptics as LinearOptics
    from catseye.calibration.resolution.predictor import PredictionMethod as PredictionMethod
    from catseye.calibration.resolution.predictor import predict_pose as predict_pose
    from catseye.calibration.resolution.recording import recording_of as recording_of
    from catseye.calibration.resolution.steps import steps as steps
    from catseye.calibration.resolution.tables import JointTable as JointTable
    from catseye.calibration.resolution.tables import ResolutionTables as ResolutionTables
    from catseye.calibration.scara.budget import Budget as Budget
    from catseye.calibration.scara.budget import Contributor as Contributor
    from catseye.calibration.scara.comparison import Comparison as Comparison
    from catseye.calibration.scara.comparison import compare as compare
    from catseye.calibration.scara.compensation import Compensation as Compensation
    from catseye.calibration.scara.compensation import compensate as compensate
    from catseye.calibration.scara.design.criterion import Criterion as Criterion
    from catseye.calibration.scara.design.sight import Rules as Rules
    from catseye.calibration.scara.design.sight import Way as Way
    from catseye.calibration.scara.design.sight import sight_of as sight_of
    from catseye.calibration.scara.design.study import Study as Study
    from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis as Diagnosis
    from catseye.calibration.scara.diagnostics.diagnosis import diagnose as diagnose
    from catseye.calibration.scara.diagnostics.problem import Problem as Problem
    from catseye.calibration.scara.diagnostics.rejection import reject as reject
    from catseye.calibration.scara.diagnostics.robust import robust_fit as robust_fit
    from catseye.calibration.scara.error_map import BidirectionalMap as BidirectionalMap
    from catseye.calibration.scara.extension import Term as Term
    from catseye.calibration.scara.extension import crosstalk as crosstalk
    from catseye.calibration.scara.extension import j4_map as j4_map
    from catseye.calibration.scara.extension import periodic as periodic
    from catseye.calibration.scara.extension import thermal_drift as thermal_drift
    from catseye.calibration.scara.found_drift import found_drifts as found_drifts
    from catseye.calibration.scara.identification import Identification as Identification
    from catseye.calibration.scara.identification import IdentifiedArm as IdentifiedArm
    from catseye.calibration.scara.identification import identify as identify
    from catseye.calibration.scara.planar import forward as forward
    from catseye.calibration.scara.planar import inverse as inverse
    from catseye.calibration.scara.plausibility.bounds import Bounds as Bounds
    from catseye.calibration.scara.plausibility.judgement import judge as judge
    from catseye.calibration.scara.points import Commands as Commands
    from catseye.calibration.scara.points import Points as Points
    from catseye.calibration.scara.prediction import Prediction as Prediction
    from catseye.calibration.scara.prediction import predict as predict
    from catseye.calibration.scara.reversal import SeparatedOrder as SeparatedOrder
    from catseye.calibration.scara.reversal import separated_orders as separated_orders
    from catseye.calibration.scara.scans.scan_identification import identify_scan as identify_scan
    from catseye.calibration.scara.scans.source import SlicedPoints as SlicedPoints
    from catseye.calibration.scara.uncertainty import contributions as contributions
    from catseye.calibration.scara.uncertainty import draw_estimates as draw_estimates
    from catseye.calibration.standards.iso230_2 import positioning as positioning
    from catseye.calibration.standards.iso230_2 import systematic_of_map as systematic_of_map

_HOMES = {
    "core.coverage": ("coverage_factor", "shortest_interval", "symmetric_interval"),
    "core.design.exchange": ("Pool", "exchange", "greedy_start"),
    "core.errors": ("CalibrationError",),
    "kinematics.chain": ("Chain", "Joint"),
    "kinematics.gravity": ("Load", "gravity_torques", "potential_energy"),
    "kinematics.inverse": ("inverse_kinematics",),
    "kinematics.jacobian": ("jacobian",),
    "kinematics.rotations": ("angles_of", "pose_of"),
    "resolution.alignment": ("align",),
    "resolution.backlash": ("backlash",),
    "resolution.cartesian_steps": ("StepSeries",),
    "resolution.decaying": ("decaying_test",),
    "resolution.iso": ("iso_amplitude", "iso_test"),
    "resolution.joint_model": ("JointModel", "table_of"),
    "resolution.measured_steps": ("MeasuredSteps",),
    "resolution.moves": ("moves_of",),
    "resolution.optics": ("AngularOptics", "LinearOptics"),
    "resolution.predictor": ("PredictionMethod", "predict_pose"),
    "resolution.recording": ("recording_of",),
    "resolution.steps": ("steps",),
    "resolution.tables": ("JointTable", "ResolutionTables"),
    "scara.budget": ("Budget", "Contributor"),
    "scara.comparison": ("Comparison", "compare"),
    "scara.compensation": ("Compensation", "compensate"),
    "scara.design.criterion": ("Criterion",),
    "scara.design.sight": ("Rules", "Way", "sight_of"),
    "scara.design.study": ("Study",),
    "scara.diagnostics.diagnosis": ("Diagnosis", "diagnose"),
    "scara.diagnostics.problem": ("Problem",),
    "scara.diagnostics.rejection": ("reject",),
    "scara.diagnostics.robust": ("robust_fit",),
    "scara.error_map": ("BidirectionalMap",),
    "scara.extension": ("Term", "crosstalk", "j4_map", "periodic", "thermal_drift"),
    "scara.found_drift": ("found_drifts",),
    "scara.identification": ("Identification", "IdentifiedArm", "identify"),
    "scara.planar": ("forward", "inverse"),
    "scara.plausibility.bounds": ("Bounds",),
    "scara.plausibility.judgement": ("judge",),
    "scara.points": ("Commands", "Points"),
    "scara.prediction": ("Prediction", "predict"),
    "scara.reversal": ("SeparatedOrder", "separated_orders"),
    "scara.scans.scan_identification": ("identify_scan",),
    "scara.scans.source": ("SlicedPoints",),
    "scara.uncertainty": ("contributions", "draw_estimates"),
    "standards.iso230_2": ("positioning", "systematic_of_map"),
}
"""Public names by the module that holds them."""

_HOME_OF = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [*_HOME_OF]


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME_OF[name]}"), name)
