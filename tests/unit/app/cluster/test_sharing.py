"""Work shared over processes: order, progress, errors, the same numbers however many there are."""

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

import numpy as np
import pytest

from catseye.app.cluster.errors import WorkerLostError
from catseye.app.cluster.share import InThisProcess, Share, map_quick
from catseye.app.cluster.sharing import cores, sharing
from catseye.app.errors import ConfigError
from catseye.app.results.scara.uncertainty import by_monte_carlo
from catseye.calibration.core.errors import UnidentifiableError
from tests.unit.app.cluster.work import (
    drawn,
    fails_at_three,
    fails_untellably,
    hears_ctrl_c,
    killed_at_three,
    large,
    process_and_threads,
)
from tests.unit.calibration.scara.samples import identified

A = TypeVar("A")
B = TypeVar("B")


@pytest.fixture(params=[1, 2])
def share(request: pytest.FixtureRequest) -> Iterator[Share]:
    with sharing(request.param, None) as found:
        yield found


def test_results_come_in_the_order_of_the_items(share: Share) -> None:
    seen: list[int] = []
    assert share.map(abs, [-5, 4, -3, 2, -1], seen.append) == [5, 4, 3, 2, 1]
    assert seen == [1, 2, 3, 4, 5]


def test_no_items_no_results(share: Share) -> None:
    assert share.map(abs, []) == []


def test_an_error_arrives_as_it_was_with_its_item(share: Share) -> None:
    with pytest.raises(UnidentifiableError, match="three") as caught:
        share.map(fails_at_three, range(8))
    assert caught.value.null_directions == [["L1"]]
    assert caught.value.__notes__ == ["in item 4 of 8: 3"]
    assert share.map(abs, [-1]) == [1], "the pool goes on after an error"


def test_an_error_that_cannot_be_pickled_is_still_reported() -> None:
    with sharing(2, None) as found, pytest.raises(RuntimeError, match="TwoPartError: two parts"):
        found.map(fails_untellably, [1])


def test_the_same_numbers_however_many_workers_there_are() -> None:
    expected = [
        float(np.random.default_rng(seed).normal(size=1000).sum())
        for seed in np.random.SeedSequence(7).spawn(5)
    ]
    for workers in (1, 2, 3):
        with sharing(workers, None) as found:
            assert found.map(drawn, np.random.SeedSequence(7).spawn(5)) == expected


def test_processes_are_others_and_have_one_thread_each(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    with sharing(2, None) as found:
        answers = found.map(process_and_threads, range(6))
    assert {threads for _, threads in answers} == {"1"}
    assert os.getpid() not in {process for process, _ in answers}
    assert os.environ["OMP_NUM_THREADS"] == "7"


def test_only_the_sharing_process_hears_ctrl_c() -> None:
    with sharing(2, None) as found:
        assert found.map(hears_ctrl_c, range(4)) == [False] * 4
    assert hears_ctrl_c(0)


def test_one_worker_is_this_process() -> None:
    with sharing(1, None) as found:
        assert found.map(process_and_threads, [0])[0][0] == os.getpid()


def test_zero_takes_one_a_core(monkeypatch: pytest.MonkeyPatch) -> None:
    if not hasattr(os, "sched_getaffinity"):
        pytest.skip("this system does not report which cores a process may use")
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1, 2})
    assert cores() == 3


def test_a_worker_that_dies_is_reported() -> None:
    with sharing(2, None) as found, pytest.raises(WorkerLostError, match="memory"):
        found.map(killed_at_three, range(8))


def test_fewer_than_no_workers() -> None:
    with pytest.raises(ValueError, match="-1 workers"), sharing(-1, None):
        pass


def test_dask_without_its_package_names_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.delitem(sys.modules, "catseye.app.cluster.machines", raising=False)
    with (
        pytest.raises(ConfigError, match=r"pip install 'catseye\[cluster\]'"),
        sharing(1, "tcp://127.0.0.1:1"),
    ):
        pass


def test_interrupted_work_does_not_wait_for_large_results() -> None:
    for _ in range(3):

        def stop(count: int) -> None:
            if count == 6:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt), sharing(2, None) as share:
            share.map(large, [20_000] * 400, stop)


class Others:
    """Takes five seconds to begin, and notes what it is given."""

    begins_after_s = 5.0

    def __init__(self) -> None:
        self.given: list[int] = []

    def map(
        self, function: Callable[[A], B], items: Sequence[A], done: Callable[[int], None] | None = None
    ) -> list[B]:
        self.given.append(len(items))
        return InThisProcess().map(function, items, done)


@pytest.mark.parametrize(("item_s", "handed_over"), [(0.01, 0), (0.1, 0), (0.4, 0), (0.6, 99)])
def test_quick_work_stays_here_until_others_pay(item_s: float, handed_over: int) -> None:
    others, now = Others(), [0.0]
    seen: list[int] = []

    def carried_out(item: int) -> int:
        now[0] += item_s
        return -item

    found = map_quick(others, carried_out, range(100), seen.append, lambda: now[0])
    assert found == [-item for item in range(100)]
    assert seen == list(range(1, 101))
    assert sum(others.given) == handed_over


def test_one_worker_hands_nothing_over() -> None:
    assert map_quick(InThisProcess(), abs, [-1, 2]) == [1, 2]


def test_draws_that_are_handed_over_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    one, found = identified(model="conventional"), []
    for workers in (1, 2):
        with sharing(workers, None) as share:
            # As if processes began at once: all draws but the first ones are theirs.
            monkeypatch.setattr(type(share), "begins_after_s", 0.0)
            found.append(by_monte_carlo(one, 2000, 7, share))
    assert found[0].part == found[1].part
    assert np.array_equal(found[0].identified.covariance, found[1].identified.covariance)
