"""identify, for points files too long to be held in memory."""

from pathlib import Path
from typing import TYPE_CHECKING

from catseye.app.analysis.extension_words import parse_extensions
from catseye.app.analysis.scan_identifying import SCAN_ROWS, identify_scan_file
from catseye.app.cell.bench import bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cli.output import say
from catseye.app.cli.progress import ProgressBar
from catseye.app.errors import UsageError
from catseye.app.files.result_json import Result
from catseye.procedures.kit.bench import Bench

if TYPE_CHECKING:
    from catseye.app.cli.identify import IdentifyOptions


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


def without_maps(result: Result) -> Result:
    """Return a result whose summary is short: maps with nodes every degree are for files and pictures."""
    return result.model_copy(update={"theta1_map": None, "theta2_map": None})


def say_scan(result: Result) -> None:
    """Say what is kept of the residuals, and which segments stand out."""
    scan = result.scan
    if scan is None:
        return
    say(f"streamed: {scan.n_sample} of {scan.n_points} residuals kept one by one, all of them by segment")
    segments = scan.segments
    worst = max(range(len(segments.rms_um)), key=lambda i: segments.rms_um[i])
    say(
        f"largest rms of a segment: {segments.rms_um[worst]:.2f} µm, {segments.reflector[worst]}/"
        f"{segments.segment[worst]}; largest residual {max(segments.largest_um):.2f} µm"
    )


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
