"""A bench of a KR 210 as an engine sends it: no SCARA, moved by steps only."""

import copy
from typing import Any, Final

from catseye.app.cell.axes import arm_of
from catseye.app.cell.bodies import workspace_of
from catseye.app.cell.model import Cell
from catseye.app.service.watching.posture import posture_of
from tests.unit.app.tui.scripted_bench import bench

CELL: Final = Cell.model_validate(
    {
        "format": "catseye-cell/1",
        "name": "kuka-1",
        "robot": {"arm": "kr210-r2700", "endpoint": "tcp://127.0.0.1:7000", "expected_model": "KR210"},
    }
)
HOME: Final = (0.0, -90.0, 90.0, 0.0, 0.0, 0.0)
"""The arm stretches forward at the height of its wrist."""

TORQUES_NM: Final = (-12.3, 1043.0, -607.2, 3.1, -42.0, 0.4)


def arm_bench(joints: tuple[float, ...] | None = HOME, **parts: Any) -> dict[str, Any]:
    """Return the bench with its joints at a pose, deg, and other parts of it replaced."""
    posture = posture_of(workspace_of(CELL), joints)
    axes = [
        {"name": axis.name, "unit": axis.unit, "low": axis.low, "high": axis.high}
        for axis in arm_of(CELL.robot).axes
    ]
    status = bench(
        cell="kuka-1",
        robot={"joints": joints, "jogs": False, "torques_nm": TORQUES_NM},
        beam={"displacement_mm": 0.523572193, "mean_mm": 0.523571, "spread_um": 0.012},
        optics={"spacing_mm": 30.0, "linear": True},
        axes=axes,
        layout=None,
        posture=None if posture is None else posture.json_object(),
    )
    devices = copy.deepcopy(status["devices"])[:3]
    devices[0]["driver"], devices[0]["identity"]["model"] = "kuka-varproxy", "KR 210 R2700"
    return {**status, "devices": devices, **parts}


def tracker_bench(**parts: Any) -> dict[str, Any]:
    """Return the bench of an arm before a tracker: neither interferometer nor air sensor."""
    status = arm_bench(beam=None, air=None, optics=None)
    tracker = {**copy.deepcopy(status["devices"][0]), "name": "tracker", "driver": "leica-emscon"}
    tracker |= {"endpoint": "tcp://127.0.0.1:700", "moves_arm": False}
    tracker["identity"] |= {"model": "AT901", "firmware": "3.8", "serial": "7001"}
    instrument = {
        "measures": ["points"],
        "nests": ["W1", "W2", "W3"],
        "targets": ["nest1", "nest2", "nest3"],
        "base_mm": [-1800.0, 300.0, -350.0],
        "base_deg": [0.0, 0.0, 0.0],
    }
    return {**status, "devices": [status["devices"][0], tracker], "instrument": instrument, **parts}
