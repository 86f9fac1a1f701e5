"""What a layout costs at the bench: the plan of the measurement and its expected time."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Bools
from catseye.procedures.kit.errors import PlanError, PlanLimitError
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.approach import Command, require_joint_limits, with_take_up
from catseye.procedures.scara.motion.tracking import plan_track
from catseye.procedures.scara.motion.visits import plan_visits, require_clear_visits


@dataclass(frozen=True)
class BenchCost:
    """What the plan of a measurement says.

    Attributes:
        duration_s: expected time, s.
        points: distances.
        blind: commands that cannot be measured, summed over the reflectors.
        breaks: times that the beam is given up, summed over the reflectors.
        refused: why the plan refuses it; empty as a rule.
    """

    duration_s: float
    points: int
    blind: int
    breaks: int
    refused: str = ""


def bench_cost(bench: ScaraBench, sequence: tuple[Command, ...], kept: Bools | None = None) -> BenchCost:
    """Plan the measurement of a bench's reflectors, as open-loop does, and say what it costs.

    Args:
        sequence: commands in measuring order.
        kept: commands that are measured, shape (n,); None for all.
    """
    commands = sequence if kept is None else tuple(sequence[k] for k in np.flatnonzero(kept))
    stops = with_take_up(commands, bench.take_up_deg)
    duration_s, points, blind, breaks = 0.0, 0, 0, 0
    try:
        require_joint_limits(stops, bench)
        for reflector in bench.reflectors:
            visits, hidden = plan_visits(
                stops, plan_track(stops, bench, reflector, subdivide=True), bench, reflector
            )
            require_clear_visits(visits, bench)
            duration_s += sum(visit.duration_s for visit in visits)
            points += len(visits)
            blind += len(hidden)
            breaks += max(0, sum(not visit.tracked for visit in visits) - 1)
    except (PlanError, PlanLimitError) as error:
        return BenchCost(float("nan"), points, blind, breaks, str(error))
    return BenchCost(duration_s, points, blind, breaks)
