"""The distances of a scan that are used, and the few of them that stand for all."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.amplitudes import even_step
from catseye.calibration.core.types import Bools, Ints
from catseye.calibration.scara.between_nodes import MeasuredPlaces
from catseye.calibration.scara.budget_effects import measured_places
from catseye.calibration.scara.layout import Layout
from catseye.calibration.scara.points import Points, concatenated, shares_passed, short_segments
from catseye.calibration.scara.scans.source import PointSource


@dataclass(frozen=True)
class UsedRows:
    """A source without the segments that are too short to carry a dead path of their own.

    Attributes:
        source: all distances.
        dead_path: new index of each dead path of the source; -1 where it is left out.
        reflector: the same of each reflector.
        reflector_names: names of those left.
        dead_paths: (reflector name, segment) of those left.
        rows: number of distances left.
        rejected: a sentence for each segment left out.
    """

    source: PointSource
    dead_path: Ints
    reflector: Ints
    reflector_names: tuple[str, ...]
    dead_paths: tuple[tuple[str, int], ...]
    rows: int
    rejected: list[str]

    @property
    def kept_reflectors(self) -> Ints:
        """Indices of the reflectors left among those of the source."""
        return np.flatnonzero(self.reflector >= 0)

    def blocks(self) -> Iterator[Points]:
        """Return the used distances in measuring order, each with its share of the measurement."""
        for block, _ in self._numbered():
            yield block

    def _numbered(self) -> Iterator[tuple[Points, Ints]]:
        """Return the blocks, and which of all distances theirs are, from 0."""
        first, asked = 0, 0
        for block in self.source.blocks():
            used = np.flatnonzero(self.dead_path[block.dead_path] >= 0)
            kept = block if used.size == len(block) else block.rows(used)
            if len(kept):
                numbered = replace(
                    kept,
                    dead_path=self.dead_path[kept.dead_path],
                    reflector=self.reflector[kept.reflector],
                    reflector_names=self.reflector_names,
                    dead_paths=self.dead_paths,
                    elapsed=shares_passed(np.arange(first, first + len(kept)), self.rows)
                    if kept.elapsed is None
                    else kept.elapsed,
                )
                yield numbered, asked + used
            first, asked = first + len(kept), asked + len(block)

    def few(self, arm: Layout) -> "FewRows":
        """Return evenly spread rows with some of each segment.

        So many rows give starting values that one full pass improves to the end.

        Args:
            arm: its nodes.
        """
        every, first, chosen, even, asked, count = even_step(self.rows), 0, [], [], [], 0
        places: MeasuredPlaces | None = None
        for block, numbers in self._numbered():
            rows = np.arange(-first % every, len(block), every)
            beginnings = np.unique(block.dead_path, return_index=True)[1]
            kept = np.union1d(rows, beginnings)
            chosen.append(block.rows(kept))
            asked.append(numbers[kept])
            even.append(count + np.flatnonzero(np.isin(kept, rows)))
            first, count = first + len(block), count + kept.size
            if places is None or not places.average_out:
                own = measured_places(arm, block.commands)
                places = own if places is None else places.joined(own)
        return FewRows(concatenated(chosen), np.concatenate(asked), np.concatenate(even), places)


@dataclass(frozen=True)
class FewRows:
    """Some rows of a scan, and what had to be looked for in all of them.

    Attributes:
        points: evenly spread rows with some of each segment.
        numbers: which of all distances they are, from 0.
        even: numbers of those that are evenly spread among them.
        places: where the joints stand between their nodes in all rows.
    """

    points: Points
    numbers: Ints
    even: Ints
    places: MeasuredPlaces | None


def used_rows(source: PointSource, check: Callable[[Points, int], None]) -> UsedRows:
    """Count the rows of each segment and leave out the short ones.

    Args:
        check: is called with each block and the number of its first row, from 1; raises if it cannot be used.
    """
    counts = np.zeros(len(source.dead_paths), dtype=np.int64)
    first = 1
    for block in source.blocks():
        check(block, first)
        first += len(block)
        counts += np.bincount(block.dead_path, minlength=counts.size)
    short, rejected = short_segments(counts, source.dead_paths)
    dead_paths = tuple(path for path, left_out in zip(source.dead_paths, short, strict=True) if not left_out)
    present = {name for name, _ in dead_paths}
    kept = np.array([name in present for name in source.reflector_names])
    rows = int(counts[~short].sum())
    return UsedRows(
        source,
        _renumbered(~short),
        _renumbered(kept),
        tuple(name for name in source.reflector_names if name in present),
        dead_paths,
        rows,
        rejected,
    )


def _renumbered(kept: Bools) -> Ints:
    return np.where(kept, np.cumsum(kept) - 1, -1).astype(np.int64)
