"""The collector beside the keys: modules are set aside once, after the collection that found them."""

import gc

from catseye.app.tui.heap import AfterCollection, modules_left_alone


class Heap:
    """Notes what is set aside."""

    def __init__(self) -> None:
        self.modules = 100
        self.frozen = 0
        self.after = AfterCollection(lambda: self.modules, self.freeze)

    def freeze(self) -> None:
        self.frozen += 1

    def collect(self, generation: int) -> None:
        for phase in ("start", "stop"):
            self.after(phase, {"generation": generation})


def test_modules_are_set_aside_after_a_full_collection_only() -> None:
    heap = Heap()
    heap.collect(0)
    heap.collect(1)
    assert heap.frozen == 0
    heap.collect(2)
    assert heap.frozen == 1


def test_without_a_new_module_nothing_is_set_aside() -> None:
    heap = Heap()
    for modules, frozen in ((100, 1), (100, 1), (130, 2), (130, 2)):
        heap.modules = modules
        heap.collect(2)
        assert heap.frozen == frozen


def test_the_collector_is_as_before_afterwards() -> None:
    before = list(gc.callbacks)
    with modules_left_alone():
        assert gc.get_freeze_count() > 0
        assert len(gc.callbacks) == len(before) + 1
    assert (gc.get_freeze_count(), gc.callbacks) == (0, before)
