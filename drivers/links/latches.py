"""What may have spoilt a count since its zero, remembered until the next zero."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from catseye.drivers.roles.errors import RefusedError


@dataclass
class Latches:
    """Memory of a length counter's driver.

    A beam that was lost makes every later count worthless until the next zero, whatever the instrument says
    afterwards. The same holds for a link that was opened again: the instrument may have started anew meanwhile,
    and nothing proves that its count went on.

    Attributes:
        beam_lost: the count was interrupted.
        overspeed: the beam's length changed faster than the instrument counts.
        values_lost: values of a stream did not arrive; the count itself holds.
        zero_id: number of the last zero.
    """

    beam_lost: bool = False
    overspeed: bool = False
    values_lost: bool = False
    zero_id: int = 0
    _was_greeted: bool = False

    def note(self, *, beam_lost: bool = False, overspeed: bool = False, values_lost: bool = False) -> None:
        """Remember the latches that an instrument reports."""
        self.beam_lost |= beam_lost
        self.overspeed |= overspeed
        self.values_lost |= values_lost

    def greeting(self) -> None:
        """Take note that a link is being opened: a count from before is not to be trusted."""
        self.beam_lost |= self._was_greeted

    def greeted(self) -> None:
        """Take note that the instrument has answered on a new link."""
        self._was_greeted = True

    @contextmanager
    def zeroing(self) -> Iterator[None]:
        """Spoil the count when it is not known whether the instrument has zeroed; one that refuses has not."""
        try:
            yield
        except RefusedError:
            raise
        except BaseException:
            # A link that heals in place proves that a count went on, not since when.
            self.note(beam_lost=True)
            raise

    def zeroed(self) -> int:
        """Forget what was before a new zero; return its number."""
        self.beam_lost = self.overspeed = self.values_lost = False
        self.zero_id += 1
        return self.zero_id
