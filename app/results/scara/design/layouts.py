"""Layouts of reflectors: found by exchange and refinement, and judged."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from catseye.app.cluster.share import Share
from catseye.app.errors import UsageError
from catseye.app.results.numbers import MDEG_PER_RAD
from catseye.app.results.scara.design.bench_time import BenchCost, bench_cost
from catseye.app.results.scara.design.problem import PAPER_MM, Problem, with_reflectors
from catseye.calibration.core.design.criteria import CriterionName, covariances
from catseye.calibration.core.design.exchange import Chosen, Pool, exchange, greedy_start, random_start
from catseye.calibration.core.design.information import Information
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.design.candidates import apart, grid
from catseye.calibration.scara.design.refinement import refine
from catseye.calibration.scara.design.sight import Reason, Sight

_STARTS = 12
"""Random starts of the exchange, beside the greedy one and the layouts that are known."""


@dataclass(frozen=True)
class Layout:
    """Reflectors with the information that they give about the arm.

    Attributes:
        problem: what they were judged for.
        name: what the table calls them.
        sights: one a reflector, in measuring order.
        information: about the arm.
    """

    problem: Problem
    name: str
    sights: tuple[Sight, ...]
    information: Information

    @property
    def places_mm(self) -> Floats:
        """Places, mm, shape (k, 2)."""
        return np.array([sight.xy_mm for sight in self.sights])

    @cached_property
    def cost(self) -> BenchCost:
        """What the plan of the whole measurement says."""
        return bench_cost(with_reflectors(self.problem.bench, self.sights), self.problem.sequence)

    def covariance(self, *, systematic: bool) -> Floats:
        """Return the covariance in the study's free directions, shape (f, f)."""
        return covariances(self.information.counted(systematic=systematic))

    def shown(self, name: CriterionName, *, systematic: bool) -> float:
        """Return the uncertainty that a criterion stands for; infinite where it is not determined."""
        criterion = self.problem.with_criterion(name)
        value = float(criterion.value(self.covariance(systematic=systematic)))
        return criterion.shown(value) if np.isfinite(value) else np.inf

    def u(self, *, systematic: bool) -> Floats:
        """Return the standard uncertainties of the arm's parameters, mm and rad, shape (p,).

        They are infinite where the layout leaves any of them undetermined.
        """
        if np.isinf(self.shown("A", systematic=systematic)):
            return np.full(self.problem.study.layout.arm_size, np.inf)
        arm = self.problem.study.arm(self.covariance(systematic=systematic))
        return np.sqrt(np.diag(arm.covariance))

    def u_of_arm(self, *, systematic: bool) -> list[float]:
        """Return the standard uncertainties of both links, µm, and the largest of each map, mdeg."""
        arm, u = self.problem.study.layout, self.u(systematic=systematic)
        links = [1e3 * float(value) for value in u[:2]]
        return links + [MDEG_PER_RAD * float(u[part].max()) for part in (arm.map1, arm.map2)]


def layout_of(problem: Problem, name: str, sights: list[Sight]) -> Layout:
    """Judge reflectors; they are measured in the order of their polar angles."""
    ordered = sorted(sights, key=lambda sight: float(np.arctan2(sight.xy_mm[1], sight.xy_mm[0])))
    brought = [problem.study.rows(sight).information() for sight in ordered]
    total = brought[0]
    for one in brought[1:]:
        total = total + one
    return Layout(problem, name, tuple(ordered), total)


@dataclass(frozen=True)
class Places:
    """Candidate places.

    Attributes:
        allowed: where a reflector may stand.
        excluded: where none may, each with its reason.
        spacing_mm: of the grid.
        pool: what the allowed places bring.
    """

    allowed: tuple[Sight, ...]
    excluded: tuple[Sight, ...]
    spacing_mm: float
    pool: Pool

    @property
    def reasons(self) -> dict[Reason, int]:
        """How many places are excluded for which reason."""
        return dict(Counter(sight.reason for sight in self.excluded).most_common())

    def indices(self, places_mm: Floats) -> Ints | None:
        """Return which allowed places these are, None where one of them is not allowed."""
        known = {tuple(sight.xy_mm): k for k, sight in enumerate(self.allowed)}
        found = [known.get(tuple(place)) for place in places_mm]
        return None if None in found else np.array(found, dtype=np.int64)


def known_layouts(problem: Problem) -> list[tuple[str, Floats]]:
    """Return the layouts to compare with: the cell file's own and, where it differs, the paper's."""
    own = np.array([reflector.xy_mm for reflector in problem.bench.reflectors])
    paper = np.array(PAPER_MM)
    if own.shape == paper.shape and np.allclose(own, paper):
        return [("cell file (= SCARA paper)", own)]
    return [("cell file", own), ("SCARA paper", paper)]


def candidate_places(problem: Problem, count: int) -> Places:
    """Look at the measurement from a grid of places and from those of the known layouts.

    Raises:
        UsageError: nowhere may a reflector stand.
    """
    lattice, spacing = grid(problem.floor, problem.rules.keep_out_mm, count)
    known = np.vstack([places for _, places in known_layouts(problem)])
    places = np.unique(np.vstack([lattice, known[problem.floor.holds(known)]]), axis=0)
    sights = [problem.sight(place) for place in places]
    allowed = tuple(sight for sight in sights if not sight.reason)
    excluded = tuple(sight for sight in sights if sight.reason)
    if not allowed:
        reasons = Counter(sight.reason for sight in excluded)
        raise UsageError(
            f"nowhere on the floor may a reflector stand ({_counts(reasons)}): give a larger --floor, a smaller "
            "--keep-out, or another [optics] in the cell file"
        )
    brought = [problem.study.rows(sight).information() for sight in allowed]
    distant = apart(np.array([sight.xy_mm for sight in allowed]), problem.rules.apart_mm)
    return Places(allowed, excluded, spacing, Pool.of(brought, distant, systematic=problem.systematic))


def best_layouts(
    problem: Problem,
    places: Places,
    counts: list[int],
    seed: int,
    share: Share,
    done: Callable[[int, int], None],
) -> list[Layout]:
    """Find the best layout of each number of reflectors.

    Args:
        done: is called with how many of how many are finished.

    Raises:
        UsageError: there is no room for so many reflectors.
        UnidentifiableError: the commands leave parameters undetermined wherever the reflectors stand.
    """
    tasks = [task for count in counts for task in _tasks(problem, places, count, seed)]
    found = share.map(_search, tasks, lambda number: done(number, len(tasks)))
    best = []
    for count in counts:
        of_count = [one for task, one in zip(tasks, found, strict=True) if task.count == count and one]
        if not of_count:
            raise UsageError(
                f"{count} reflectors do not find room on {len(places.allowed)} places at least "
                f"{problem.rules.apart_mm:g} mm apart: ask for fewer --reflectors or more --places, a larger "
                "--floor, or a smaller --apart"
            )
        best.append(min(of_count, key=lambda one: one.value))
    for one in best:
        if np.isinf(one.value):
            problem.study.require_determined([places.allowed[k] for k in one.places])
    refined = share.map(_refined, [(problem, places, one) for one in best])
    return [layout_of(problem, f"{len(one)} designed", one) for one in refined]


@dataclass(frozen=True)
class _Task:
    """One start of the exchange: a layout, or a seed of a random one, or, with neither, a greedy one."""

    problem: Problem
    pool: Pool
    count: int
    start: Ints | None = None
    seed: tuple[int, int, int] | None = None


def _tasks(problem: Problem, places: Places, count: int, seed: int) -> list[_Task]:
    pool = places.pool
    known = [places.indices(layout) for _, layout in known_layouts(problem) if len(layout) == count]
    usable = [start for start in known if start is not None and _keeps_apart(pool, start)]
    return [
        *(_Task(problem, pool, count, start) for start in usable),
        _Task(problem, pool, count),
        *(_Task(problem, pool, count, seed=(seed, count, number)) for number in range(_STARTS)),
    ]


def _keeps_apart(pool: Pool, start: Ints) -> bool:
    return bool((pool.compatible[np.ix_(start, start)] | np.eye(start.size, dtype=np.bool_)).all())


def _search(task: _Task) -> Chosen | None:
    start = task.start
    if start is None and task.seed is not None:
        start = random_start(task.pool, task.count, np.random.default_rng(task.seed))
    elif start is None:
        start = greedy_start(task.pool, task.count, task.problem.criterion)
    return None if start is None else exchange(task.pool, start, task.problem.criterion)


def _refined(task: tuple[Problem, Places, Chosen]) -> list[Sight]:
    problem, places, chosen = task
    start = np.array([places.allowed[k].xy_mm for k in chosen.places])
    valued = _Valued(problem)
    refined, _ = refine(start, valued, 0.5 * places.spacing_mm)
    return [problem.sight(place) for place in refined]


class _Valued:
    """The criterion of a layout anywhere on the floor; what a place brings is worked out once."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._known: dict[tuple[float, ...], Information | None] = {}

    def __call__(self, places_mm: Floats) -> float:
        """Return the criterion of places of shape (k, 2); infinite where one of them is not allowed."""
        distant = apart(places_mm, self._problem.rules.apart_mm) | np.eye(len(places_mm), dtype=np.bool_)
        if not distant.all():
            return float("inf")
        brought = [self._brought(place) for place in places_mm]
        total = brought[0]
        for one in brought[1:]:
            total = None if total is None or one is None else total + one
        if total is None:
            return float("inf")
        counted = total.counted(systematic=self._problem.systematic)
        return float(self._problem.criterion.value(covariances(counted)))

    def _brought(self, place: Floats) -> Information | None:
        key = tuple(float(value) for value in place)
        if key not in self._known:
            self._known[key] = self._information(place) if self._problem.floor.holds(place) else None
        return self._known[key]

    def _information(self, place: Floats) -> Information | None:
        sight = self._problem.sight(place)
        return None if sight.reason else self._problem.study.rows(sight).information()


def _counts(reasons: Counter[Reason]) -> str:
    return ", ".join(f"{count} {reason}" for reason, count in reasons.most_common())
