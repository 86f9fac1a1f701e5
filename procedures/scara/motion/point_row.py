"""A measured point as a record."""

from dataclasses import replace

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Measurement
from catseye.procedures.kit.records import Row
from catseye.procedures.scara.motion.approach import Command
from catseye.procedures.scara.records import Distance


def title_of(reflector: str, command: Command) -> str:
    """Return a point in words."""
    return (
        f"{reflector}: θ1 {command.theta1_deg:g}° ({'+' if command.direction1 > 0 else '−'}), "
        f"θ2 {command.theta2_deg:g}° ({'+' if command.direction2 > 0 else '−'})"
    )


def distance_of(
    reflector: str, segment: int, command: Command, sent: Pose, measured: Measurement, mount_deg: float = 0.0
) -> Distance:
    """Return the record of a distance.

    Args:
        segment: number of the unbroken stretch.
        command: the node.
        mount_deg: angle by which the interferometer is turned against its first mounting.
    """
    reported, used = measured.reported, measured.correction
    distance = Distance(
        reflector=reflector,
        segment=segment,
        theta1_deg=command.theta1_deg,
        theta2_deg=command.theta2_deg,
        j3_mm=sent[2],
        j4_deg=sent[3],
        mount_deg=mount_deg,
        reported1_deg=reported[0],
        reported2_deg=reported[1],
        reported3_mm=reported[2],
        reported4_deg=reported[3],
        direction1=command.direction1,
        direction2=command.direction2,
        displacement_mm=measured.displacement_mm,
        spread_mm=measured.spread_mm,
        readings=measured.readings,
        signal=measured.beam.signal,
        time_utc=measured.time_utc,
        duration_s=measured.duration_s,
        temperature_c=measured.air.temperature_c,
        pressure_hpa=measured.air.pressure_hpa,
        humidity_percent=measured.air.humidity_percent,
        extra=links_of(measured),
    )
    if used is None:
        return distance
    return replace(
        distance,
        raw_displacement_mm=used.raw_displacement_mm,
        refractive_index=used.refractive_index,
        zero_refractive_index=used.zero_refractive_index,
        dead_path_mm=used.dead_path_mm,
        formula=used.formula,
    )


def links_of(measured: Measurement) -> Row:
    """Return the temperature of the links; nothing without a sensor."""
    return {} if measured.material_c is None else {"material_c": measured.material_c}
