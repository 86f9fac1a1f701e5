"""The process that draws pictures of runs: a line of JSON asks for them, a line of JSON answers."""

import json
import os
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Final

from catseye.app.errors import CatseyeError
from catseye.app.results.figures import Figure
from catseye.app.results.live_figures import LiveFigures
from catseye.app.tui.pictures import NOTHING, Pictures, Wanted
from catseye.app.tui.widgets.wall_drawing import draw_wall
from catseye.calibration.core.errors import CalibrationError

_NICE: Final = 5
"""Measuring comes first."""


class Painting:
    """Looks at one run at a time, and keeps what it has seen."""

    def __init__(self) -> None:
        self._looks: tuple[Path, LiveFigures] | None = None
        self._figures: tuple[Figure, ...] = ()
        self._note = NOTHING

    def draw(self, wanted: Wanted) -> Pictures:
        """Return the pictures of a run."""
        if wanted.look or self._looks is None or self._looks[0] != wanted.path:
            self._look(wanted.path)
        if not self._figures:
            return Pictures(note=self._note)
        first = wanted.first % len(self._figures)
        order = (*self._figures[first:], *self._figures[:first])
        titles = tuple(figure.label for figure in self._figures)
        if wanted.width < 1 or wanted.height < 1:
            return Pictures(titles, first)
        lines, shown = draw_wall(order, wanted.width, wanted.height)
        return Pictures(titles, first, shown, tuple(lines))

    def _look(self, path: Path) -> None:
        if self._looks is None or self._looks[0] != path:
            self._looks = path, LiveFigures(path)
        try:
            self._figures, self._note = self._looks[1].look(), NOTHING
        except (CatseyeError, CalibrationError) as error:
            self._figures, self._note = (), str(error)


def main() -> None:
    """Answer until nobody asks any more."""
    os.nice(_NICE)
    painting = Painting()
    for line in sys.stdin:
        asked = json.loads(line)
        pictures = painting.draw(Wanted(**{**asked, "path": Path(asked["path"])}))
        sys.stdout.write(f"{json.dumps(asdict(pictures))}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
