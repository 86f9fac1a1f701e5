"""The garbage collector leaves runs alone and keeps nothing of them."""

import gc
import weakref
from collections.abc import Iterator

import pytest

from catseye.app.engine.heap import settled_heap


class _Ring:
    """Garbage that only the collector finds."""

    def __init__(self) -> None:
        self.itself = self


@pytest.fixture(autouse=True)
def thawed() -> Iterator[None]:
    gc.unfreeze()
    yield
    gc.unfreeze()


def test_what_is_there_is_left_alone_during_a_run() -> None:
    with settled_heap():
        assert gc.get_freeze_count() > 0


def test_nothing_stays_frozen_after_a_run() -> None:
    with settled_heap():
        pass
    assert gc.get_freeze_count() == 0


def test_a_run_that_fails_leaves_nothing_frozen() -> None:
    with pytest.raises(ValueError, match="failed"), settled_heap():
        raise ValueError("failed")
    assert gc.get_freeze_count() == 0


def test_what_one_run_left_is_collected_before_the_next() -> None:
    ring = _Ring()
    seen = weakref.ref(ring)
    with settled_heap():
        del ring
    with settled_heap():
        assert seen() is None
