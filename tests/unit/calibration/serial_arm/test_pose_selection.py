"""Exchange of poses against indices by singular values and a search of every exchange."""

import numpy as np
import pytest

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.design.exchange import growth, select, value_of
from catseye.calibration.serial_arm.design.observability import INDICES, Index

COUNT = 6


def candidates(seed: int = 1, number: int = 40) -> Floats:
    rng = np.random.default_rng(seed)
    return rng.standard_normal((number, 3, 7)) * rng.uniform(0.01, 100.0, 7)


def by_singular_values(rows: Floats, chosen: list[int], index: Index) -> float:
    """Return an index as its authors wrote it, in columns of unit rms norm a candidate."""
    scale = np.sqrt(np.mean(np.sum(rows**2, axis=1), axis=0))
    sigma = np.linalg.svd((rows[chosen] / scale).reshape(-1, rows.shape[-1]), compute_uv=False)
    return {
        "O1": float(np.prod(sigma) ** (1.0 / sigma.size) / np.sqrt(len(chosen))),
        "O2": float(sigma[-1] / sigma[0]),
        "O3": float(sigma[-1]),
        "O4": float(sigma[-1] ** 2 / sigma[0]),
        "O5": float(1.0 / np.sum(1.0 / sigma)),
    }[index]


@pytest.mark.parametrize("index", INDICES)
def test_value_is_that_of_the_singular_values(index: Index) -> None:
    rows = candidates()
    found = select(rows, COUNT, index)
    assert found.value == pytest.approx(by_singular_values(rows, found.chosen.tolist(), index), rel=1e-9)
    assert value_of(rows, found.chosen, index) == pytest.approx(found.value, rel=1e-12)


def require_no_better_exchange(rows: Floats, chosen: list[int], index: Index) -> None:
    best = by_singular_values(rows, chosen, index)
    for place in range(COUNT):
        for other in set(range(len(rows))) - set(chosen):
            tried = [*chosen[:place], other, *chosen[place + 1 :]]
            assert by_singular_values(rows, tried, index) <= best * (1.0 + 1e-6)


@pytest.mark.parametrize("index", INDICES)
def test_no_exchange_of_one_pose_is_better(index: Index) -> None:
    rows = candidates(2)
    chosen = select(rows, COUNT, index).chosen.tolist()
    require_no_better_exchange(rows, chosen, index)


def test_every_pose_is_chosen_once() -> None:
    chosen = select(candidates(3, 12), 10).chosen
    assert len(set(chosen.tolist())) == 10


def test_progress_tells_starts_and_the_best_value() -> None:
    seen: list[tuple[int, int, float]] = []
    found = select(candidates(), COUNT, starts=3, progress=lambda *state: seen.append(state))
    assert [state[:2] for state in seen] == [(1, 3), (2, 3), (3, 3)]
    assert seen[-1][2] == found.value


def test_index_per_pose_of_many_alike_poses_settles() -> None:
    values = growth(candidates(4, 60), np.array([4, 8, 16]))
    assert values[1] > 0.8 * values[0]
    assert np.all(np.isfinite(values))


def test_too_few_poses_for_the_parameters_are_refused() -> None:
    with pytest.raises(InsufficientPointsError, match="choose at least 3 poses"):
        select(candidates(), 2)


def test_more_poses_than_candidates_are_refused() -> None:
    with pytest.raises(InsufficientPointsError, match="12 candidates for 13 poses"):
        select(candidates(5, 12), 13)


@pytest.mark.parametrize("index", INDICES)
def test_what_is_known_beforehand_counts_as_rows_of_each_choice(index: Index) -> None:
    rows = candidates(5)
    known = np.array([0.0, 0.0, 4.0, 0.0, 1.0, 0.0, 9.0])
    found = select(rows, COUNT, index, known=known)
    scale = np.sqrt(np.mean(np.sum(rows**2, axis=1), axis=0))
    stacked = np.vstack([(rows[found.chosen] / scale).reshape(-1, 7), np.diag(np.sqrt(known) / scale)])
    sigma = np.linalg.svd(stacked, compute_uv=False)
    expected = {
        "O1": float(np.prod(sigma) ** (1.0 / sigma.size) / np.sqrt(COUNT)),
        "O2": float(sigma[-1] / sigma[0]),
        "O3": float(sigma[-1]),
        "O4": float(sigma[-1] ** 2 / sigma[0]),
        "O5": float(1.0 / np.sum(1.0 / sigma)),
    }
    assert found.value == pytest.approx(expected[index], rel=1e-9)


@pytest.mark.parametrize("index", INDICES)
def test_poses_of_fewer_targets_have_rows_of_zeros(index: Index) -> None:
    rows = candidates(6)
    rows[::2, 1:] = 0.0
    chosen = select(rows, COUNT, index).chosen.tolist()
    require_no_better_exchange(rows, chosen, index)


def test_known_parameters_need_no_rows() -> None:
    rows = candidates(7)
    with pytest.raises(InsufficientPointsError, match="choose at least 3 poses"):
        select(rows, 2)
    assert len(select(rows, 2, known=np.array([0, 0, 0, 0, 0, 0, 1.0])).chosen) == 2
