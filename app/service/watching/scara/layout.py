"""A SCARA's bench from above, of what the cell file says and of where the arm stands."""

from catseye.app.protocol.scara.layout import Layout, ReflectorPlace
from catseye.app.service.watching.bench_facts import BenchFacts
from catseye.drivers.roles.pose import Pose
from catseye.procedures.scara.bench import ScaraBench


def layout_of(facts: BenchFacts, joints: Pose | None) -> Layout | None:
    """Return the bench from above; None where it is no SCARA's or nobody has described it."""
    bench = facts.bench
    if not isinstance(bench, ScaraBench):
        return None
    optics = bench.optics
    return Layout(
        link1_mm=bench.link1_mm,
        link2_mm=bench.link2_mm,
        column_radius_mm=optics.column_radius_mm,
        theta40_deg=optics.theta40_deg,
        limits_deg={"j1": bench.j1_limits_deg, "j2": bench.j2_limits_deg, "j4": bench.j4_limits_deg},
        reflectors=tuple(
            ReflectorPlace(
                name=reflector.name,
                x_mm=reflector.x_mm,
                y_mm=reflector.y_mm,
                facing_deg=reflector.facing_deg,
                field_half_angle_deg=optics.field_half_angle_deg,
            )
            for reflector in bench.reflectors
        ),
        aim=None if joints is None else facts.system.aimed_at(joints),
    )
