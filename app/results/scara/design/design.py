"""A design: where to put reflectors, what that brings, what it costs, and how it compares."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from catseye.app.cluster.share import Share
from catseye.app.results.scara.design.commands import CommandChoice, choose, choose_for_time
from catseye.app.results.scara.design.layouts import (
    Layout,
    Places,
    best_layouts,
    candidate_places,
    known_layouts,
    layout_of,
)
from catseye.app.results.scara.design.problem import Problem
from catseye.app.results.scara.design.reversal import Reversal, reversals
from catseye.calibration.core.design.criteria import covariances, pareto_front
from catseye.calibration.core.design.exchange import Pool
from catseye.calibration.core.design.information import Information
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.arm import arm_design
from catseye.calibration.scara.points import Commands

Done = Callable[[float, float, str], None]
"""Called with how much of how much is done, and what is under way."""

_FRONT_COUNTS = (1, 2, 3, 4)
_FRONT_SHARES = (0.25, 0.5, 0.75, 1.0)
_FRONT_REPEATS = (1, 2, 3)


@dataclass(frozen=True)
class Wanted:
    """How much is to be designed.

    Attributes:
        reflectors: how many.
        places: candidate places.
        seed: of the starts.
        commands: how many commands to keep; None for all, or what the minutes allow.
        minutes: bench time; None for any.
        pareto: work out the front.
    """

    reflectors: int
    places: int
    seed: int
    commands: int | None = None
    minutes: float | None = None
    pareto: bool = False


@dataclass(frozen=True)
class Compromise:
    """One way to spend bench time.

    Attributes:
        reflectors: how many.
        commands: how many of the sequence are measured.
        repeats: how often.
        time_s: expected, s.
        u_white: criterion as an uncertainty, what averages out alone.
        u_total: the same with what does not.
        front: nothing else is both faster and more certain.
    """

    reflectors: int
    commands: int
    repeats: int
    time_s: float
    u_white: float
    u_total: float
    front: bool = False

    def u(self, *, systematic: bool) -> float:
        """Return the criterion as an uncertainty, with or without what does not average out."""
        return self.u_total if systematic else self.u_white


@dataclass(frozen=True)
class Design:
    """Everything that was found.

    Attributes:
        problem: what was asked.
        places: candidates.
        layout: the chosen one.
        known: layouts to compare with.
        choice: a part of the commands; None for all.
        compromises: bench time against uncertainty; empty unless asked for.
        reversals: of each layout, what a second mounting of the interferometer is worth.
    """

    problem: Problem
    places: Places
    layout: Layout
    known: tuple[Layout, ...]
    choice: CommandChoice | None
    compromises: tuple[Compromise, ...]
    reversals: tuple[Reversal, ...] = ()

    @property
    def layouts(self) -> tuple[Layout, ...]:
        """The chosen layout and those to compare with."""
        return (self.layout, *self.known)


def design(problem: Problem, wanted: Wanted, share: Share, done: Done) -> Design:
    """Find a layout and what belongs to it.

    Args:
        done: is called with the progress.

    Raises:
        UsageError: no place is allowed, there is no room for so many, or the minutes do not suffice.
        UnidentifiableError: the commands leave parameters undetermined.
    """
    places = candidate_places(problem, wanted.places)
    counts = [wanted.reflectors]
    if wanted.pareto:
        counts += [count for count in _FRONT_COUNTS if count != wanted.reflectors]
    best = best_layouts(
        problem, places, counts, wanted.seed, share, lambda number, of: done(number, of, "exchanges")
    )
    known = tuple(_known(problem, name, xy) for name, xy in known_layouts(problem))
    front = _compromises(sorted(best, key=lambda one: len(one.sights)), share, done) if wanted.pareto else ()
    worth = reversals((best[0], *known))
    return Design(problem, places, best[0], known, _choice(best[0], wanted), front, worth)


def _known(problem: Problem, name: str, places_mm: Floats) -> Layout:
    """Judge a known layout; reflectors that the cell file describes look where it says."""
    facing = {tuple(reflector.xy_mm): reflector.facing_deg for reflector in problem.bench.reflectors}
    return layout_of(problem, name, [problem.sight(xy, facing.get(tuple(xy))) for xy in places_mm])


def _choice(layout: Layout, wanted: Wanted) -> CommandChoice | None:
    if wanted.minutes is not None:
        return choose_for_time(layout, 60.0 * wanted.minutes)
    return None if wanted.commands is None else choose(layout, wanted.commands)


def _compromises(layouts: list[Layout], share: Share, done: Done) -> tuple[Compromise, ...]:
    tasks = [(layout, part) for layout in layouts for part in _FRONT_SHARES]
    found = share.map(_compromise, tasks, lambda n: done(n, len(tasks), "commands and bench times"))
    rows = [row for group in found for row in group]
    systematic = layouts[0].problem.systematic
    costs = np.array([[row.time_s, row.u(systematic=systematic)] for row in rows])
    # What the plan refuses, or what is undetermined, is no compromise.
    sound = np.isfinite(costs).all(axis=1)
    flags = pareto_front(np.where(sound[:, None], costs, np.inf)) & sound
    marked = [
        Compromise(
            row.reflectors, row.commands, row.repeats, row.time_s, row.u_white, row.u_total, bool(flag)
        )
        for row, flag in zip(rows, flags, strict=True)
    ]
    return tuple(sorted(marked, key=lambda row: row.time_s))


def _compromise(task: tuple[Layout, float]) -> list[Compromise]:
    """Return what a share of the commands costs and brings, measured once, twice, three times."""
    layout, part = task
    problem = layout.problem
    choice = choose(layout, round(part * len(problem.sequence)))
    rows = []
    for repeats in _FRONT_REPEATS:
        information = choice.information.times(repeats)
        white, total = (
            float(problem.criterion.value(covariances(information.counted(systematic=systematic))))
            for systematic in (False, True)
        )
        rows.append(
            Compromise(
                len(layout.sights),
                int(choice.kept.sum()),
                repeats,
                repeats * choice.cost.duration_s,
                problem.criterion.shown(white) if np.isfinite(white) else np.inf,
                problem.criterion.shown(total) if np.isfinite(total) else np.inf,
            )
        )
    return rows


@dataclass(frozen=True)
class NodeUncertainty:
    """Standard uncertainty of one value of a map.

    Attributes:
        joint: 1 or 2.
        node_deg: command angle.
        direction: state of approach, 1 or -1.
        white_mdeg: what averages out alone.
        total_mdeg: everything.
        systematic: the criterion counts everything.
    """

    joint: int
    node_deg: float
    direction: int
    white_mdeg: float
    total_mdeg: float
    systematic: bool

    @property
    def u_mdeg(self) -> float:
        """What the criterion counts."""
        return self.total_mdeg if self.systematic else self.white_mdeg


def node_uncertainties(layout: Layout) -> list[NodeUncertainty]:
    """Return the uncertainties of all values of both maps, J1 first, positive direction first."""
    arm = layout.problem.study.layout
    white, total = (1e3 * np.rad2deg(layout.u(systematic=systematic)) for systematic in (False, True))
    counted = layout.problem.systematic
    places = [
        (joint, float(node), sign)
        for joint, nodes in ((1, arm.nodes1_rad), (2, arm.nodes2_rad))
        for sign in (1, -1)
        for node in np.rad2deg(nodes)
    ]
    return [
        NodeUncertainty(joint, round(node, 6), sign, float(white[2 + k]), float(total[2 + k]), counted)
        for k, (joint, node, sign) in enumerate(places)
    ]


def position_covariances(layout: Layout, commands: Commands, *, systematic: bool) -> Floats:
    """Return the covariances of predicted positions, mm², shape (n, 2, 2)."""
    study = layout.problem.study
    gradient = study.gradient(arm_design(study.layout, commands))
    covariance = layout.covariance(systematic=systematic)
    return np.asarray(gradient @ covariance @ np.swapaxes(gradient, 1, 2), dtype=np.float64)


def weakest(layout: Layout, each: int = 2) -> list[NodeUncertainty]:
    """Return the most uncertain values of each map."""
    values = node_uncertainties(layout)
    return [
        one
        for joint in (1, 2)
        for one in sorted((v for v in values if v.joint == joint), key=lambda v: -v.u_mdeg)[:each]
    ]


def exchanged_values(design: Design) -> tuple[int, Floats]:
    """Return what the criterion would be with one reflector elsewhere, as an uncertainty.

    Returns:
        The reflector that is missed least, counted from 0, and the value with it at each allowed place, shape (m,);
        infinite where the layout would not determine the arm.
    """
    problem, pool = design.problem, design.places.pool
    brought = [problem.study.rows(sight).information() for sight in design.layout.sights]
    rests = [_sum([one for i, one in enumerate(brought) if i != k], pool) for k in range(len(brought))]
    values = [float(problem.criterion.value(pool.covariances(rest))) for rest in rests]
    least = int(np.argmin(values))
    reached = problem.criterion.value(pool.covariances(rests[least] + pool.brought))
    shown = [problem.criterion.shown(float(one)) if np.isfinite(one) else np.inf for one in reached]
    return least, np.array(shown)


def _sum(brought: list[Information], pool: Pool) -> Information:
    if brought:
        return Information.stacked(brought).total()
    free, sources = pool.brought.effects.shape[1:]
    return Information.none(free, sources)
