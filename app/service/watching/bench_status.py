"""The bench as clients that watch see it, made of the latest values and of what the cell file says."""

import math
from typing import Final

from catseye.app.cell.axes import may_move_an_arm
from catseye.app.cell.model import Air
from catseye.app.protocol.bench import (
    AirStatus,
    AxisRange,
    BeamStatus,
    BenchStatus,
    DeviceStatus,
    Identity,
    OpticsStatus,
    RobotStatus,
)
from catseye.app.service.watching.bench_facts import BenchFacts, DeviceFacts
from catseye.app.service.watching.instrument import instrument_of
from catseye.app.service.watching.latest_values import LatestValues, LinkValues, Stamped
from catseye.app.service.watching.posture import posture_of
from catseye.app.service.watching.scara.layout import layout_of
from catseye.calibration.air import refractive_index
from catseye.drivers.roles.air import AirSample
from catseye.procedures.kit.bench import Bench

_TORQUES_AGE_S: Final = 15.0


def bench_status(
    facts: BenchFacts, latest: LatestValues, *, moving: bool, simulated: bool | None, free_bytes: int | None
) -> BenchStatus:
    """Return the bench as it is now.

    Args:
        moving: the run under way moves the arm.
        simulated: as the run under way knows it; None asks the devices.
        free_bytes: of the disk that runs are stored on; None where that is not known.
    """
    door, joints = latest.door_closed, None if latest.joints is None else latest.joints.value
    layout = layout_of(facts, joints)
    return BenchStatus(
        cell=facts.cell,
        simulated=_simulated(latest) if simulated is None else simulated,
        disk_free_bytes=free_bytes,
        devices=tuple(_device(device, latest) for device in facts.devices),
        robot=_robot(facts, latest, moving=moving),
        beam=_beam(latest),
        air=_air(latest, facts.air),
        door_closed=None if door is None else door.value,
        layout=layout,
        posture=posture_of(facts.bench.workspace, joints) if layout is None else None,
        optics=_optics(facts.bench),
        instrument=instrument_of(facts.bench),
        axes=tuple(
            AxisRange(name=axis.name, unit=axis.unit, low=axis.low, high=axis.high, speed=axis.speed)
            for axis in facts.bench.arm.axes
        ),
    )


def _optics(bench: Bench) -> OpticsStatus | None:
    angular = bench.angular_optics
    if angular is None and bench.linear_optics is None:
        return None
    spacing_mm = None if angular is None else angular.spacing_mm
    return OpticsStatus(spacing_mm=spacing_mm, linear=bench.linear_optics is not None)


def _simulated(latest: LatestValues) -> bool | None:
    """Return whether all devices that are known are emulated; None when none is known."""
    known = [link.identity.simulated for link in latest.links.values() if link.identity is not None]
    return all(known) if known else None


def _device(device: DeviceFacts, latest: LatestValues) -> DeviceStatus:
    link = latest.links.get(device.name) or LinkValues()
    return DeviceStatus(
        name=device.name,
        endpoint=device.endpoint,
        driver=device.driver,
        moves_arm=may_move_an_arm(device.name, device.driver),
        link=link.state,
        identity=None
        if link.identity is None
        else Identity.model_validate(link.identity, from_attributes=True),
        error=link.error,
        age_s=None if link.heard_s is None else latest.age_s(link.heard_s),
    )


def _oldest_s(latest: LatestValues, *values: Stamped[object] | None) -> float:
    """Return the age of the oldest value: what is shown together is no fresher than that."""
    return max(latest.age_s(value.time_s) for value in values if value is not None)


def _robot(facts: BenchFacts, latest: LatestValues, *, moving: bool) -> RobotStatus | None:
    seen, joints = latest.status, latest.joints
    if seen is None:
        return None
    status = seen.value
    return RobotStatus(
        joints=None if joints is None else tuple(_number(value) for value in joints.value),
        servo_on=status.servo_on,
        override_percent=_number(status.override_percent),
        override_cap_percent=facts.override_cap_percent,
        alarm_number=status.alarm_number,
        alarm_text=status.alarm_text,
        emergency_stop=status.emergency_stop,
        teach_mode=status.teach_mode,
        machine_locked=status.machine_locked,
        moving=moving or status.running,
        jogs=facts.abilities.jogs,
        resets_alarms=facts.abilities.resets_alarms,
        torques_nm=_torques(latest),
        age_s=_oldest_s(latest, seen, joints),
    )


def _torques(latest: LatestValues) -> tuple[float | None, ...] | None:
    """Return the torques where they are no older than between two moves of a series: they change with every one."""
    seen = latest.torques_nm
    if seen is None or latest.age_s(seen.time_s) > _TORQUES_AGE_S:
        return None
    return tuple(_number(value) for value in seen.value)


def _beam(latest: LatestValues) -> BeamStatus | None:
    seen, length = latest.beam, latest.displacement_mm
    if seen is None:
        return None
    beam, spread_mm = seen.value, latest.columns.spread()
    return BeamStatus(
        signal=_number(beam.signal),
        signal_native=beam.signal_native,
        beam_ok=beam.beam_ok,
        beam_lost=beam.beam_lost,
        overspeed=beam.overspeed,
        laser_ready=beam.laser_ready,
        displacement_mm=None if length is None else length.value,
        mean_mm=latest.columns.mean(),
        spread_um=None if spread_mm is None else 1e3 * spread_mm,
        age_s=_oldest_s(latest, seen, length),
    )


def _air(latest: LatestValues, rule: Air) -> AirStatus | None:
    seen = latest.air
    if seen is None:
        return None
    air = seen.value
    return AirStatus(
        temperature_c=_number(air.temperature_c),
        pressure_hpa=_number(air.pressure_hpa),
        humidity_percent=_number(air.humidity_percent),
        refractive_index=_index(air, rule),
        formula=rule.formula,
        age_s=latest.age_s(seen.time_s),
    )


def _number(value: float | None) -> float | None:
    """Return a number that JSON can carry, None for any other."""
    return value if value is not None and math.isfinite(value) else None


def _index(air: AirSample, rule: Air) -> float | None:
    """Return the refractive index of the air; None when a quantity is missing or out of the formula's range."""
    temperature_c, pressure_hpa, humidity_percent = air.temperature_c, air.pressure_hpa, air.humidity_percent
    if temperature_c is None or pressure_hpa is None or humidity_percent is None:
        return None
    state = (temperature_c, pressure_hpa, humidity_percent, rule.co2_ppm)
    try:
        return float(refractive_index(rule.vacuum_wavelength_nm, *state, formula=rule.formula))
    except ValueError:
        return None
