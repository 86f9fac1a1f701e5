"""identify, for points files too long to be held in memory."""

from pathlib import Path
from typing import TYPE_CHECKING

from catseye.app.cell.bench import bench_of
from catseye.app.cell.load import load_cell
from catseye.app.commands.progress import ProgressBar
from catseye.app.errors import UsageError
from catseye.app.files.result_json import Result
from catseye.app.results.scara.extensions import parse_extensions
from catseye.app.results.scara.scan import SCAN_ROWS, identify_scan_file
from catseye.procedures.kit.bench import Bench

if TYPE_CHECKING:
    from catseye.app.commands.identify import IdentifyOptions


def identified_scan(points: Path, cell: Path, options: "IdentifyOptions") -> tuple[Result, Bench]:
    """Identify from a long points file, with bars for reading and for solving.

    Raises:
        UsageError: an option is asked for that needs all distances at once, or a file is wrong.
    """
    _require_streamable(points, options)
    bench, terms = bench_of(load_cell(cell).cell), parse_extensions(options.extend)
    with _Bar("reading") as reading, _Bar("solving") as solving:
        result = identify_scan_file(
            points,
            bench,
            options.model,
            terms,
            lambda share: reading.update(share, 1.0, points.name),
            lambda done, expected: solving.update(done, expected, f"{done} of {expected} rows"),
        )
    return result, bench


class _Bar:
    """A progress bar whose time begins with the first thing that it shows.

    Args:
        title: what is under way.
    """

    def __init__(self, title: str) -> None:
        self._title = title
        self._bar: ProgressBar | None = None

    def __enter__(self) -> "_Bar":
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()

    def update(self, done: float, total: float, text: str) -> None:
        """Show how far it is; the line above is left first."""
        if self._bar is None:
            self._bar = ProgressBar(self._title)
        self._bar.update(done, total, text)
        if done >= total:
            self._bar.close()


def _require_streamable(points: Path, options: "IdentifyOptions") -> None:
    asked = [
        name
        for name, given in (
            ("--uncertainty monte-carlo", options.uncertainty != "jacobian"),
            (f"--loss {options.loss}", options.loss != "squares"),
            ("--reject", options.reject is not None),
        )
        if given
    ]
    if asked:
        raise UsageError(
            f"{points}: is streamed, as Parquet and more than {SCAN_ROWS} distances are, and {', '.join(asked)} "
            "needs all distances at once: leave it out, or thin the points (every tenth row, say) into a CSV file"
        )
