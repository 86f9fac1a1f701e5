"""Kinematics of arms: the planar SCARA, serial chains, bodies and the ways that these sweep."""

from catseye.calibration.kinematics.planar import Hand as Hand
from catseye.calibration.kinematics.planar import forward as forward
from catseye.calibration.kinematics.planar import inverse as inverse
from catseye.calibration.kinematics.planar import position_jacobian as position_jacobian
from catseye.calibration.kinematics.planar import wrap_rad as wrap_rad
