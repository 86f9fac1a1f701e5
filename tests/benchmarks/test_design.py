"""Three reflectors among 400 places, and a choice of commands: against the same with dense factorisations."""

import time
from collections.abc import Callable
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
from scipy import linalg

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cluster.share import InThisProcess
from catseye.app.results.scara.design.layouts import Places, best_layouts, candidate_places
from catseye.app.results.scara.design.problem import Problem, Wish, problem_of
from catseye.calibration.core.design.exchange import Pool, exchange, random_start
from catseye.calibration.core.design.row_choice import CommandPool, choose_commands
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.scara.design.candidates import apart
from catseye.calibration.scara.design.criterion import Criterion
from tests.unit.calibration.scara.design.cases import SIGMA_MM, SMALL, scaled, seen_by_all, study

PLACES = 400


def problem(folder: Path) -> Problem:
    cell = folder / "cell.toml"
    cell.write_text(TEMPLATE)
    loaded = load_cell(cell).cell
    return problem_of(scara_bench_of(loaded), loaded.uncertainty.budget, Wish("A", systematic=False))


def exactly(places: Places, count: int) -> Places:
    """Return the first so many allowed places."""
    pool = places.pool
    first = Pool(pool.brought[:count], pool.compatible[:count, :count], systematic=False)
    return replace(places, allowed=places.allowed[:count], pool=first)


def timed(work: Callable[[], object]) -> float:
    start_s = time.perf_counter()
    work()
    return time.perf_counter() - start_s


def dense_trace(blocks: list[tuple[Floats, Floats]]) -> float:
    """Return the trace of the arm's covariance by a QR factorisation of the dense Jacobian."""
    free = blocks[0][0].shape[1]
    jacobian = np.hstack(
        [np.vstack([arm for arm, _ in blocks]), linalg.block_diag(*(own for _, own in blocks))]
    )
    triangle = linalg.qr(jacobian, mode="r", check_finite=False)[0][: jacobian.shape[1]]
    inverse = linalg.solve_triangular(triangle, np.eye(len(triangle)), check_finite=False)
    return float(np.sum(inverse[:free] ** 2))


def naive_exchange(blocks: list[tuple[Floats, Floats]], compatible: Bools, start: Ints) -> tuple[Ints, float]:
    """Remove one, add the best one, by factorising every trial."""
    chosen = start.copy()
    value, idle, position = dense_trace([blocks[k] for k in chosen]), 0, 0
    while idle < chosen.size:
        others = np.delete(chosen, position)
        best = int(chosen[position])
        for place in np.flatnonzero(compatible[others].all(axis=0)):
            if place in others:
                continue
            reached = dense_trace([blocks[k] for k in [*others, place]])
            if reached < value * (1.0 - 1e-9):
                best, value = int(place), reached
        idle = idle + 1 if best == chosen[position] else 1
        chosen[position] = best
        position = (position + 1) % chosen.size
    return np.sort(chosen), value


def test_three_reflectors_among_400_places(tmp_path: Path) -> None:
    posed = problem(tmp_path)
    found: list[float] = []

    def design() -> None:
        places = exactly(candidate_places(posed, 1150), PLACES)
        assert len(places.allowed) == PLACES
        layout = best_layouts(posed, places, [3], 1, InThisProcess(), lambda _number, _of: None)[0]
        found.append(layout.shown("A", systematic=False))

    took_s = timed(design)
    places = exactly(candidate_places(posed, 1150), PLACES)
    blocks = []
    for sight in places.allowed:
        rows = posed.study.rows(sight)
        blocks.append((rows.wanted[sight.seen], rows.nuisance[sight.seen]))
    start = random_start(places.pool, 3, np.random.default_rng(3))
    assert start is not None
    begun = start
    mine_s = timed(lambda: exchange(places.pool, begun, posed.criterion))
    mine = exchange(places.pool, begun, posed.criterion)
    result: list[tuple[Ints, float]] = []
    naive_s = timed(lambda: result.append(naive_exchange(blocks, places.pool.compatible, begun)))
    print(  # noqa: T201  # the figure
        f"\ndesign, 3 of {PLACES} places, A, 14 starts and refinement: {took_s:.2f} s (aim 5), "
        f"{found[0]:.3f} mdeg; "
        f"one exchange {1e3 * mine_s:.0f} ms, with dense factorisations {naive_s:.1f} s, ratio {naive_s / mine_s:.0f}"
    )
    assert np.array_equal(mine.places, result[0][0])
    assert abs(mine.value / result[0][1] - 1.0) < 1e-6
    assert naive_s / mine_s > 20.0


def test_within_one_percent_of_the_exhaustive_optimum() -> None:
    angles = np.deg2rad(np.linspace(-120.0, 70.0, 12))
    places = np.array([[r * np.cos(a), r * np.sin(a)] for r in (640.0, 820.0) for a in angles])
    blocks = [SMALL.block(place) for place in places]
    every: dict[tuple[int, ...], float] = {
        chosen: float(
            np.trace(
                scaled(SMALL, SMALL.covariance([blocks[k] for k in chosen], places[list(chosen)], SIGMA_MM))
            )
        )
        for chosen in combinations(range(len(places)), 3)
    }
    posed = study(SMALL)
    brought = [posed.rows(seen_by_all(place, len(posed.commands))).information() for place in places]
    pool = Pool.of(brought, apart(places, 1.0), systematic=False)
    criterion = Criterion("A", SMALL.arm_size, np.zeros((1, SMALL.arm_size - 1)))
    found = []
    for number in range(12):
        start = random_start(pool, 3, np.random.default_rng((1, 3, number)))
        assert start is not None
        found.append(exchange(pool, start, criterion))
    best = min(found, key=lambda one: one.value)
    ratio = every[tuple(int(k) for k in best.places)] / min(every.values())
    print(f"\nexchange over the best of all {len(every)} layouts: {ratio:.4f} (limit 1.01)")  # noqa: T201  # the figure
    assert ratio <= 1.01


def naive_choice(pool: CommandPool, count: int, criterion: Criterion) -> Bools:
    """Leave out the least useful command one by one, by inverting every trial."""
    kept = np.ones(len(pool.rows), dtype=np.bool_)
    while kept.sum() > count:
        values = []
        for row in np.flatnonzero(kept):
            kept[row] = False
            values.append(pool.value(kept, criterion))
            kept[row] = True
        kept[np.flatnonzero(kept)[int(np.argmin(values))]] = False
    return kept


def test_choice_of_commands_by_rank_updates(tmp_path: Path) -> None:
    posed = problem(tmp_path)
    sights = [posed.sight(reflector.xy_mm) for reflector in posed.bench.reflectors]
    pool = CommandPool.of([posed.study.rows(sight) for sight in sights], systematic=False)
    left_out = 20
    count = len(pool.rows) - left_out
    mine_s = timed(lambda: choose_commands(pool, count, posed.criterion))
    mine = choose_commands(pool, count, posed.criterion)
    naive: list[Bools] = []
    naive_s = timed(lambda: naive.append(naive_choice(pool, count, posed.criterion)))
    print(  # noqa: T201  # the figure
        f"\nleaving out {left_out} of {len(pool.rows)} commands: {1e3 * mine_s:.0f} ms by rank updates, "
        f"{naive_s:.1f} s by inverting every trial, ratio {naive_s / mine_s:.0f}"
    )
    assert pool.value(mine, posed.criterion) <= pool.value(naive[0], posed.criterion) * (1.0 + 1e-6)
    assert naive_s / mine_s > 20.0
