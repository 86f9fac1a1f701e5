"""Where the distances of a scan come from: blocks, as often as they are asked for."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from catseye.calibration.core.arguments import require_count
from catseye.calibration.scara.points import Points


class PointSource(Protocol):
    """Distances that need not fit into memory."""

    @property
    def reflector_names(self) -> tuple[str, ...]:
        """Names of all reflectors."""
        ...

    @property
    def dead_paths(self) -> tuple[tuple[str, int], ...]:
        """(Reflector name, segment) of all dead paths."""
        ...

    def __len__(self) -> int:
        """Return the number of distances."""
        ...

    def blocks(self) -> Iterator[Points]:
        """Return all distances in measuring order, anew at each call; each block has all names of the source."""
        ...


@dataclass(frozen=True)
class SlicedPoints:
    """Points in memory as a source.

    Attributes:
        points: all distances.
        rows: of a block.
    """

    points: Points
    rows: int = 50_000

    def __post_init__(self) -> None:
        require_count(self.rows, "rows of a block")

    @property
    def reflector_names(self) -> tuple[str, ...]:
        """Names of all reflectors."""
        return self.points.reflector_names

    @property
    def dead_paths(self) -> tuple[tuple[str, int], ...]:
        """(Reflector name, segment) of all dead paths."""
        return self.points.dead_paths

    def __len__(self) -> int:
        """Return the number of distances."""
        return len(self.points)

    def blocks(self) -> Iterator[Points]:
        """Return all distances in measuring order."""
        for first in range(0, len(self.points), self.rows):
            yield self.points.rows(np.arange(first, min(first + self.rows, len(self.points))))
