"""A bench as an engine sends it, and a beam that was sampled."""

import copy
import math
from typing import Any

from catseye.app.protocol.bench import BenchStatus
from tests.unit.app.tui.scripted import ScriptedLink
from tests.unit.app.tui.scripted_run import AXES


def _device(name: str, driver: str, port: int, model: str, firmware: str, serial: str) -> dict[str, Any]:
    return {
        "name": name,
        "endpoint": f"tcp://127.0.0.1:{port}",
        "driver": driver,
        "moves_arm": name == "robot",
        "link": "ok",
        "identity": {"model": model, "firmware": firmware, "serial": serial, "simulated": True},
        "error": None,
        "age_s": 0.1,
    }


def _reflector(name: str, x_mm: float, y_mm: float, facing_deg: float) -> dict[str, Any]:
    return {"name": name, "x_mm": x_mm, "y_mm": y_mm, "facing_deg": facing_deg, "field_half_angle_deg": 80.0}


_RANGES = ((-170.0, 170.0), (-145.0, 145.0), (0.0, 150.0), (-360.0, 360.0))

BENCH: dict[str, Any] = {
    "cell": "lab-1",
    "simulated": True,
    "disk_free_bytes": 12_000_000_000,
    "devices": [
        _device("robot", "melfa-r3", 10001, "RH-3FRH5515", "F2", "E-4711"),
        _device("interferometer", "line-counter", 10002, "counter", "1.0", "7"),
        _device("environment", "modbus-air", 10502, "PTU300", "1.8", "K123"),
        _device("tracker", "bench-tracker", 10099, "tracker", "1.0", ""),
    ],
    "robot": {
        "joints": [20.0, 60.0, 50.0, -147.366],
        "servo_on": False,
        "override_percent": 10.0,
        "override_cap_percent": 20.0,
        "alarm_number": 0,
        "alarm_text": "",
        "emergency_stop": False,
        "teach_mode": False,
        "moving": False,
        "jogs": True,
        "resets_alarms": True,
        "age_s": 0.1,
    },
    "beam": {
        "signal": 0.62,
        "signal_native": "",
        "beam_ok": True,
        "beam_lost": False,
        "overspeed": False,
        "laser_ready": True,
        "displacement_mm": 743.123456,
        "mean_mm": 743.122987,
        "spread_um": 1.234,
        "age_s": 0.1,
    },
    "air": {
        "temperature_c": 20.12,
        "pressure_hpa": 1013.2,
        "humidity_percent": 45.0,
        "refractive_index": 1.00027123,
        "formula": "ciddor",
        "age_s": 0.5,
    },
    "door_closed": None,
    "axes": [{**axis, "low": low, "high": high} for axis, (low, high) in zip(AXES, _RANGES, strict=True)],
    "layout": {
        "link1_mm": 325.0,
        "link2_mm": 225.0,
        "column_radius_mm": 110.0,
        "theta40_deg": 0.0,
        "limits_deg": {"j1": [-170.0, 170.0], "j2": [-145.0, 145.0], "j4": [-360.0, 360.0]},
        "reflectors": [
            _reflector("P1", 650.0, -400.0, 148.4),
            _reflector("P2", 680.0, 0.0, 180.0),
            _reflector("P3", 640.0, 380.0, -149.3),
        ],
        "aim": "P1",
    },
    "missed": 0,
}
"""All is well: the links stand at 20 and 80 deg, the beam points at P1."""


def bench(**parts: Any) -> dict[str, Any]:
    """Return that bench with other parts; a dict changes what it names, anything else replaces."""
    status = copy.deepcopy(BENCH)
    for name, part in parts.items():
        if isinstance(part, dict) and isinstance(status.get(name), dict):
            status[name].update(part)
        else:
            status[name] = part
    return status


def bench_status(**parts: Any) -> BenchStatus:
    """Return that bench, with other parts, as screens have it."""
    return BenchStatus.model_validate(bench(**parts))


def publish_strip(link: ScriptedLink, columns: int = 500, at_mm: float = 743.121) -> None:
    """Publish ten seconds of the beam: a slow wave, a gap, and one spike of a single sample."""
    low: list[float | None] = [at_mm + 0.002 * math.sin(number / 40) for number in range(columns)]
    high = [None if value is None else value + 0.0005 for value in low]
    high[columns // 2] = at_mm + 0.009
    for number in range(columns // 5, columns // 4):
        low[number] = high[number] = None
    count = [0 if value is None else 4 for value in low]
    link.publish(
        "samples",
        quantity="displacement_mm",
        period_s=0.02,
        low=low,
        high=high,
        count=count,
        missed=0,
    )
