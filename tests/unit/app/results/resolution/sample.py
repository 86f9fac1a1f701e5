"""Results made by hand: joints whose step errors grow towards small steps, backlash, a staircase."""

import math
from typing import Any

import numpy as np

from catseye.app.results.resolution.predicted import PredictedResolution
from catseye.app.results.resolution.result import ResolutionResult
from catseye.calibration.resolution.tables import ExpectedErrors, JointTable, Sector

_SEED = 3
RATIO = 1.072267
_POSITIONS = {"A1": (-175.0, -90.0, 0.0, 90.0, 175.0), "A5": (-110.0, 0.0, 110.0)}
_LEAST = {"A1": 1.5e-4, "A5": 2.5e-3}


def decaying(joint: str, position_deg: float, direction: int) -> dict[str, Any]:
    """Return a test of 109 steps; the least step is stated as made."""
    rng = np.random.default_rng((_SEED, round(position_deg) + 360, direction + 1))
    command = 0.1 / RATIO ** np.arange(109)
    scatter = 2.0 + 8.0 * _LEAST[joint] / command
    error = 10.0 * _LEAST[joint] / command + rng.normal(0.0, scatter)
    mean = np.convolve(error, np.ones(11) / 11.0, "same")
    lis = _LEAST[joint]
    return {
        "test": "decaying",
        "joint": joint,
        "position_deg": position_deg,
        "direction": direction,
        "threshold_percent": 10.0,
        "moves": [
            {
                "command_deg": direction * c,
                "measured_deg": direction * c * (1.0 + 0.01 * e),
                "error_percent": e,
                "mean_percent": m,
                "std_percent": s,
            }
            for c, e, m, s in zip(command, error, mean, scatter, strict=True)
        ],
        "lis_deg": {"value": lis, "u": 0.1 * lis, "low": 0.85 * lis, "high": 1.25 * lis},
        "reversal_deg": None,
        "duration_s": 545.0,
        "flags": [],
    }


def iso(joint: str, position_deg: float) -> dict[str, Any]:
    """Return a test by ISO 230 with its staircase: 10 steps up, 10 down, 10 up, flat at the reversals."""
    command = 20.0 * _LEAST[joint]
    signs = np.repeat([1.0, -1.0, 1.0], 10)
    moved = np.where(np.arange(30) % 10 < 2, 0.1, 1.0) * signs
    plateau = np.concatenate([[0.0], np.cumsum(moved)]) * command
    t_s = np.arange(0.0, 155.0, 0.25)
    return {
        "test": "iso",
        "joint": joint,
        "position_deg": position_deg,
        "direction": None,
        "threshold_percent": 10.0,
        "moves": [
            {"command_deg": c, "measured_deg": c * m * c / abs(c), "error_percent": None}
            for c, m in zip(signs * command, moved, strict=True)
        ],
        "lis_deg": {"value": command, "u": 0.2 * command, "low": 0.8 * command, "high": 1.5 * command},
        "duration_s": 155.0,
        "staircase": {
            "t_s": t_s.tolist(),
            "position_deg": plateau[np.minimum((t_s // 5.0).astype(int), 30)].tolist(),
            "plateau_t_s": (5.0 * np.arange(31) + 3.7).tolist(),
            "plateau_deg": plateau.tolist(),
            "plateau_s": 2.0,
        },
        "flags": ["moves 1, 2, 11, 12, 21, 22: no velocity peak; measured as what the plateaus say"],
    }


def backlash(joint: str, position_deg: float, *, valid: bool | None) -> dict[str, Any]:
    """Return a backlash test of 0.005° at −175°, more elsewhere."""
    value = 0.005 + 1e-3 * math.cos(math.radians(position_deg))
    torque = {
        True: {"forward_nm": 12.0, "backward_nm": -9.0},
        False: {"forward_nm": 25.0, "backward_nm": 4.0},
    }
    return {
        "test": "backlash",
        "joint": joint,
        "position_deg": position_deg,
        "direction": None,
        "threshold_percent": 10.0,
        "moves": [],
        "lis_deg": None,
        "reversal_deg": {"value": value, "u": 2e-5, "valid": valid},
        "torque": None if valid is None else torque[valid],
        "duration_s": 525.0,
        "flags": [],
    }


def cartesian(axis: str, direction: int, pose: str, least_mm: float | None) -> dict[str, Any]:
    """Return a test of a direction; without a least step it could not be stated."""
    command = 1.0 / RATIO ** np.arange(80)
    lis = None
    if least_mm is not None:
        lis = {"value": least_mm, "u": 0.1 * least_mm, "low": 0.8 * least_mm, "high": 1.3 * least_mm}
    return {
        "test": "cartesian",
        "joint": axis,
        "position_mm": None,
        "direction": direction,
        "threshold_percent": 10.0,
        "pose": pose,
        "moves": [
            {
                "command_mm": direction * c,
                "measured_mm": direction * c * 1.02,
                "error_percent": 2.0,
                "mean_percent": 2.0,
            }
            for c in command
        ],
        "lis_mm": lis,
        "lis_reason": None if lis else "no step kept within the threshold",
        "reversal_mm": None,
        "flags": [] if lis else ["no step kept within the threshold"],
    }


def sample_result() -> ResolutionResult:
    """Return a result with tests of every kind."""
    tests: list[dict[str, Any]] = []
    for joint, positions in _POSITIONS.items():
        for position in positions:
            tests += [decaying(joint, position, 1), decaying(joint, position, -1), iso(joint, position)]
            tests.append(backlash(joint, position, valid=joint == "A1" or position < 0.0))
    tests += [cartesian(axis, sign, "P1", 0.02) for axis in "XYZ" for sign in (1, -1)]
    tests.append(cartesian("X", 1, "P2", None))
    return ResolutionResult.model_validate(
        {
            "arm": "KR 210 R2700",
            "actuation": [
                {"joint": "A1", "gear_ratio": 256.86, "encoder_bits": 18},
                {"joint": "A5", "gear_ratio": 209.67, "encoder_bits": 18},
            ],
            "tests": tests,
            "provenance": {
                "runs": ["resolution-1"],
                "software": "catseye 0.2.0",
                "created": "2026-01-02T03:04:05+00:00",
                "simulated": True,
            },
        }
    )


def sample_prediction() -> PredictedResolution:
    """Return a prediction of the six translations at P1: +X a little too small, −X not known."""
    command = (1.0 / RATIO ** np.arange(80)).tolist()
    curve = {"command": command, "mean_percent": [1.0] * 80, "std_percent": [2.0] * 80}
    known = {"lis": 0.018, "low": 0.012, "high": 0.025, "reason": "", "curve": curve}
    steps = [
        {"pose": "P1", "direction": f"{sign}{axis}", "unit": "mm"} | known for axis in "XYZ" for sign in "+-"
    ]
    steps[0] |= {"lis": 0.009, "low": 0.006, "high": 0.012}
    steps[1] |= {
        "lis": None,
        "low": None,
        "high": None,
        "reason": "the tables hold nothing of A2",
        "curve": None,
    }
    return PredictedResolution.model_validate(
        {
            "arm": "KR 210 R2700",
            "tables": "tables.csv",
            "threshold_percent": 10.0,
            "draws": 50,
            "seed": 1,
            "simulated": False,
            "software": "catseye 0.2.0",
            "created": "2026-01-03T03:04:05+00:00",
            "least_steps": steps,
        }
    )


def sample_tables() -> list[JointTable]:
    """Return a table of A1 upwards: an expected error of −3 % and 4 % of scatter everywhere."""
    flat = np.ones(2)
    errors = ExpectedErrors(-3.0 * flat, 4.0 * flat, 0.0 * flat)
    return [JointTable("A1", 1, tuple(Sector(at, np.array([1e-4, 0.1]), errors) for at in (-175.0, 175.0)))]
