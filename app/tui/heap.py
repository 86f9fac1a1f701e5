"""The garbage collector beside the keys: it walks through what was imported once, not again and again."""

import gc
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager


@contextmanager
def modules_left_alone() -> Iterator[None]:
    """Keep the collector from walking through modules, which takes 160 ms in which no key is served."""
    after = AfterCollection(lambda: len(sys.modules), gc.freeze)
    after.settle()
    gc.callbacks.append(after)
    try:
        yield
    finally:
        gc.callbacks.remove(after)
        gc.unfreeze()


class AfterCollection:
    """Sets aside what a full collection has left, if modules were imported before it.

    What is set aside with them and becomes garbage stays for the life of the process: little, since modules are
    imported a few times only.

    Args:
        modules: returns how many there are.
        freeze: sets aside what there is now.
    """

    def __init__(self, modules: Callable[[], int], freeze: Callable[[], None]) -> None:
        self._modules = modules
        self._freeze = freeze
        self._settled = 0

    def __call__(self, phase: str, info: Mapping[str, int]) -> None:
        """Called by the collector, before and after its work."""
        if phase == "stop" and info["generation"] == 2:
            self.settle()

    def settle(self) -> None:
        """Set aside what there is, unless no module has come since."""
        count = self._modules()
        if count > self._settled:
            self._settled = count
            self._freeze()
