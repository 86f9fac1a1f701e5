"""The automated open-loop measurement as a plan: every move, point, break and check before anything moves."""

from dataclasses import dataclass, replace

from catseye.procedures.kit.errors import PlanError
from catseye.procedures.scara.bench import Reflector, ScaraBench
from catseye.procedures.scara.motion.approach import (
    Command,
    Waypoint,
    require_joint_limits,
    with_take_up,
)
from catseye.procedures.scara.motion.tracking import plan_track
from catseye.procedures.scara.motion.visits import (
    Leg,
    Visit,
    break_warnings,
    plan_visits,
    require_clear_visits,
)
from catseye.procedures.scara.open_loop.closures import Closure, plan_closures
from catseye.procedures.scara.open_loop.off_node import measuring_sequence
from catseye.procedures.scara.open_loop.remount_plan import RemountPlan, plan_remount, turned_bench

_FEWEST_SEEN = 0.5
"""A reflector that fewer than this share of the commands see stands in the wrong place."""


@dataclass(frozen=True)
class ReflectorPlan:
    """The measurement of one reflector.

    Attributes:
        reflector: what is aimed at.
        visits: points in measuring order.
        blind: commands from which the reflector cannot be seen; they are left out.
        planned_breaks: segments beyond the first.
        closures: trips back to a pose that was measured before, in the order in which they are driven.
        closure_warnings: why there are fewer of them than were wanted.
    """

    reflector: Reflector
    visits: tuple[Visit, ...]
    blind: tuple[Command, ...]
    planned_breaks: int
    closures: tuple[Closure, ...] = ()
    closure_warnings: tuple[str, ...] = ()

    @property
    def duration_s(self) -> float:
        """Expected time of all visits and trips, s."""
        parts: tuple[Visit | Closure, ...] = (*self.visits, *self.closures)
        return sum(part.duration_s for part in parts)

    def shifted(self, j4_deg: float, j3_mm: float) -> "ReflectorPlan":
        """Return the plan with J4 turned further everywhere, at a height of J3."""

        def moved(legs: tuple[Leg, ...]) -> tuple[Leg, ...]:
            return tuple(tuple((one, two, j3_mm, four + j4_deg) for one, two, _, four in leg) for leg in legs)

        return replace(
            self,
            visits=tuple(replace(visit, legs=moved(visit.legs)) for visit in self.visits),
            closures=tuple(
                replace(closure, out=moved(closure.out), back=moved(closure.back))
                for closure in self.closures
            ),
        )


@dataclass(frozen=True)
class Rules:
    """What is decided while measuring.

    Attributes:
        recovery_attempts: failures in a row to get a lost beam back before the operator is asked.
        drift_limit_mm: largest drift of a closure visit that is not warned of.
        stop_at_mdeg: standard uncertainty of both maps at which the points that are left are left out; 0 never.
    """

    recovery_attempts: int = 3
    drift_limit_mm: float = 0.030
    stop_at_mdeg: float = 0.0


@dataclass(frozen=True)
class OpenLoopPlan:
    """The whole measurement.

    Attributes:
        bench: what it was made from.
        reflectors: one plan each, in measuring order.
        warnings: what the operator should know before it starts.
        rules: what is decided while measuring.
        remount: how the interferometer is turned then; None where it is not.
        turned: the reflectors once more with the interferometer turned by exactly half a turn.
    """

    bench: ScaraBench
    reflectors: tuple[ReflectorPlan, ...]
    warnings: tuple[str, ...]
    rules: Rules = Rules()
    remount: RemountPlan | None = None
    turned: tuple[ReflectorPlan, ...] = ()

    @property
    def duration_s(self) -> float:
        """Expected time of all visits and trips, and of the alignment between the halves, s."""
        between_s = 0.0 if self.remount is None else self.remount.duration_s
        return between_s + sum(plan.duration_s for plan in (*self.reflectors, *self.turned))

    @property
    def n_points(self) -> int:
        """Number of points."""
        return sum(len(plan.visits) for plan in (*self.reflectors, *self.turned))

    @property
    def n_distances(self) -> int:
        """Number of points and returns."""
        return self.n_points + sum(len(plan.closures) for plan in (*self.reflectors, *self.turned))


def plan_open_loop(
    bench: ScaraBench,
    *,
    subdivide: bool = True,
    take_up: bool = True,
    reflectors: tuple[str, ...] = (),
    closures: int = 0,
    off_node: int = 0,
    j4_reversal: bool = False,
) -> OpenLoopPlan:
    """Plan the paper's measurement for every reflector.

    Args:
        bench: nominal arm, reflectors as well as they are known, limits.
        subdivide: split moves so that the beam is kept; False drives point to point, to show what breaks.
        take_up: bring each joint to its node from its proper side; False shows what that shifts.
        reflectors: names of the reflectors to measure; all of the cell when empty.
        closures: trips to a reference pose for each reflector; none without subdivision and take-up, which they
            would undo.
        off_node: commands between the nodes.
        j4_reversal: everything a second time with the interferometer turned by half a turn.

    Raises:
        PlanLimitError: a joint, take-up included, or J4 leaves its limits.
        PlanError: a reflector is hidden from too many points, stands in the arm's way, or is unknown; the beam of the
            turned interferometer cannot be aligned.
    """
    commands = measuring_sequence(bench.nodes1_deg, bench.nodes2_deg, off_node)
    stops = (
        with_take_up(commands, bench.take_up_deg)
        if take_up
        else tuple(Waypoint(c.theta1_deg, c.theta2_deg, c) for c in commands)
    )
    require_joint_limits(stops, bench)

    def planned(at: ScaraBench) -> tuple[ReflectorPlan, ...]:
        trips = closures if subdivide and take_up else 0
        plans = tuple(_reflector_plan(stops, at, one, subdivide, trips) for one in at.chosen(reflectors))
        for plan in plans:
            require_clear_visits(plan.visits, at)
        return plans

    plans = planned(bench)
    plan = OpenLoopPlan(bench, plans, _warnings(plans))
    if not j4_reversal:
        return plan
    turned = planned(turned_bench(bench))
    more = tuple(text for text in _warnings(turned) if text not in plan.warnings)
    return replace(
        plan,
        warnings=(*plan.warnings, *(f"turned half, {text}" for text in more)),
        remount=plan_remount(bench, reflectors),
        turned=turned,
    )


def _reflector_plan(
    stops: tuple[Waypoint, ...], bench: ScaraBench, reflector: Reflector, subdivide: bool, closures: int
) -> ReflectorPlan:
    track = plan_track(stops, bench, reflector, subdivide)
    visits, blind = plan_visits(stops, track, bench, reflector)
    _require_sight(visits, reflector, len(visits) + len(blind), bench)
    breaks = sum(not visit.tracked for visit in visits) - 1
    trips, warnings = plan_closures(visits, closures, bench, reflector) if closures else ((), ())
    return ReflectorPlan(reflector, visits, blind, breaks, trips, warnings)


def _require_sight(
    visits: tuple[Visit, ...], reflector: Reflector, n_commands: int, bench: ScaraBench
) -> None:
    if len(visits) >= _FEWEST_SEEN * n_commands:
        return
    optics = bench.optics
    raise PlanError(
        f"reflector {reflector.name} at ({reflector.x_mm:g}, {reflector.y_mm:g}) mm can be seen from only "
        f"{len(visits)} of {n_commands} commands: the base column ({optics.column_radius_mm:g} mm and "
        f"{optics.column_margin_mm:g} mm margin), the reflector's field (±{optics.field_half_angle_deg:g}° about "
        f"{reflector.facing_deg:g}°) or the beam's range ({optics.beam_min_mm:g}…{optics.beam_max_mm:g} mm) hides "
        "it; put the reflector elsewhere, turn it, or correct its place in the cell file"
    )


def _warnings(plans: tuple[ReflectorPlan, ...]) -> tuple[str, ...]:
    return tuple(text for plan in plans for text in _warnings_of(plan))


def _warnings_of(plan: ReflectorPlan) -> list[str]:
    texts = []
    if plan.blind:
        first = plan.blind[0]
        texts.append(
            f"reflector {plan.reflector.name}: {len(plan.blind)} commands are blind and left out, the first at "
            f"θ1 = {first.theta1_deg:g}°, θ2 = {first.theta2_deg:g}°"
        )
    return [*texts, *break_warnings(plan.reflector, plan.planned_breaks), *plan.closure_warnings]
