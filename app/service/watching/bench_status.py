"""What a client that watches is told: the `bench` message, made of gauges and facts."""

import math

import numpy as np

from catseye.app.cell.air import AirRule
from catseye.app.service.watching.bench_facts import BenchFacts
from catseye.app.service.watching.latest_values import Gauges, LinkGauge, Stamped
from catseye.calibration.air import refractive_index
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.pointing import beam_miss
from catseye.drivers.roles.protocols import Air, DeviceIdentity, Joints
from catseye.procedures.kit.context import Json

_AIMED_AT_MM = 25.0
"""A beam that passes a reflector's place nearer than this is meant for it; rough places are no better known."""


def bench_message(
    facts: BenchFacts, gauges: Gauges, *, moving: bool, simulated: bool | None, free_bytes: int | None
) -> dict[str, Json]:
    """Return the fields of a `bench` message.

    Args:
        facts: of the bench.
        gauges: what its devices told.
        moving: the run under way moves the arm.
        simulated: of the run under way, where that is known.
        free_bytes: of the disk that runs are stored on; None where that is not known.
    """
    door = gauges.door_closed
    return {
        "cell": facts.cell,
        "simulated": _simulated(gauges) if simulated is None else simulated,
        "disk_free_bytes": free_bytes,
        "devices": [_device(each.name, each.endpoint, each.driver, gauges) for each in facts.devices],
        "robot": _robot(facts, gauges, moving=moving),
        "beam": _beam(gauges),
        "air": _air(gauges, facts.air),
        "door_closed": None if door is None else door.value,
        "layout": _layout(facts, None if gauges.joints is None else gauges.joints.value),
        "missed": 0,
    }


def _simulated(gauges: Gauges) -> bool | None:
    """Return whether all devices that are known are emulated; None when none is known."""
    known = [link.identity.simulated for link in gauges.links.values() if link.identity is not None]
    return all(known) if known else None


def _device(name: str, endpoint: str, driver: str, gauges: Gauges) -> dict[str, Json]:
    link = gauges.links.get(name) or LinkGauge()
    return {
        "name": name,
        "endpoint": endpoint,
        "driver": driver,
        "link": link.state,
        "identity": None if link.identity is None else _identity(link.identity),
        "error": link.error,
        "age_s": None if link.heard_s is None else gauges.age_s(link.heard_s),
    }


def _identity(identity: DeviceIdentity) -> dict[str, Json]:
    return {
        "model": identity.model,
        "firmware": identity.firmware,
        "serial": identity.serial,
        "simulated": identity.simulated,
    }


def _oldest_s(gauges: Gauges, *values: Stamped[object] | None) -> float:
    """Return the age of the oldest value: what is shown together is no fresher than that."""
    return max(gauges.age_s(value.time_s) for value in values if value is not None)


def _robot(facts: BenchFacts, gauges: Gauges, *, moving: bool) -> Json:
    seen, joints = gauges.status, gauges.joints
    if seen is None:
        return None
    status = seen.value
    return {
        "joints": None if joints is None else [_number(value) for value in joints.value],
        "servo_on": status.servo_on,
        "override_percent": _number(status.override_percent),
        "override_cap_percent": facts.override_cap_percent,
        "alarm_number": status.alarm_number,
        "alarm_text": status.alarm_text,
        "emergency_stop": status.emergency_stop,
        "teach_mode": status.teach_mode,
        "moving": moving or status.running,
        "age_s": _oldest_s(gauges, seen, joints),
    }


def _beam(gauges: Gauges) -> Json:
    seen, length = gauges.beam, gauges.displacement_mm
    if seen is None:
        return None
    beam, spread_mm = seen.value, gauges.columns.spread()
    return {
        "signal": _number(beam.signal),
        "signal_native": getattr(beam, "signal_native", ""),
        "beam_ok": beam.beam_ok,
        "beam_lost": beam.beam_lost,
        "overspeed": beam.overspeed,
        "laser_ready": beam.laser_ready,
        "displacement_mm": None if length is None else length.value,
        "mean_mm": gauges.columns.mean(),
        "spread_um": None if spread_mm is None else 1e3 * spread_mm,
        "age_s": _oldest_s(gauges, seen, length),
    }


def _air(gauges: Gauges, rule: AirRule) -> Json:
    seen = gauges.air
    if seen is None:
        return None
    air = seen.value
    return {
        "temperature_c": _number(air.temperature_c),
        "pressure_hpa": _number(air.pressure_hpa),
        "humidity_percent": _number(air.humidity_percent),
        "refractive_index": _index(air, rule),
        "formula": rule.formula,
        "age_s": gauges.age_s(seen.time_s),
    }


def _number(value: float | None) -> float | None:
    """Return a number that JSON can tell, None for any other."""
    return value if value is not None and math.isfinite(value) else None


def _index(air: Air, rule: AirRule) -> float | None:
    """Return the refractive index of the air; None when a quantity is missing or out of the formula's range."""
    temperature_c, pressure_hpa, humidity_percent = air.temperature_c, air.pressure_hpa, air.humidity_percent
    if temperature_c is None or pressure_hpa is None or humidity_percent is None:
        return None
    state = (temperature_c, pressure_hpa, humidity_percent, rule.co2_ppm)
    try:
        return float(refractive_index(rule.vacuum_wavelength_nm, *state, formula=rule.formula))
    except ValueError:
        return None


def _layout(facts: BenchFacts, joints: Joints | None) -> dict[str, Json]:
    bench = facts.bench
    arm, optics = bench.arm, bench.optics
    return {
        "link1_mm": arm.link1_mm,
        "link2_mm": arm.link2_mm,
        "column_radius_mm": optics.column_radius_mm,
        "theta40_deg": optics.theta40_deg,
        "limits_deg": {
            "j1": list(arm.j1_limits_deg),
            "j2": list(arm.j2_limits_deg),
            "j4": list(arm.j4_limits_deg),
        },
        "reflectors": [
            {
                "name": reflector.name,
                "x_mm": reflector.x_mm,
                "y_mm": reflector.y_mm,
                "facing_deg": reflector.facing_deg,
                "field_half_angle_deg": optics.field_half_angle_deg,
            }
            for reflector in bench.reflectors
        ],
        "aim": None if joints is None else _aim(facts, joints),
    }


def _aim(facts: BenchFacts, joints: Joints) -> str | None:
    """Return the reflector that the beam is meant for; None when it passes all of them."""
    bench = facts.bench
    theta1, theta2, _, theta4 = np.radians(joints)
    place_mm = forward(theta1, theta2, bench.arm.link1_mm, bench.arm.link2_mm)
    places_mm = np.array([[reflector.x_mm, reflector.y_mm] for reflector in bench.reflectors])
    world_rad = theta1 + theta2 + theta4 + math.radians(bench.optics.theta40_deg)
    miss_mm = beam_miss(place_mm, world_rad, places_mm)
    nearest = int(np.argmin(miss_mm))
    return bench.reflectors[nearest].name if miss_mm[nearest] <= _AIMED_AT_MM else None
