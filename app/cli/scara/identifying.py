"""How identify finds an arm: from distances held in memory, or from a points file too long for that."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.load import load_cell
from catseye.app.cli.progress import ProgressBar
from catseye.app.cluster.share import Share
from catseye.app.errors import UsageError
from catseye.app.results.runs.run_source import interferometer_of
from catseye.app.results.scara.distances import DistanceSource
from catseye.app.results.scara.identify import (
    identified_result,
    parse_extensions,
    problem_of_points,
    with_gears,
    with_what_speaks_against,
)
from catseye.app.results.scara.material import with_reference_links
from catseye.app.results.scara.plausible import failures_explained, require_plausible
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.robust import identify_robustly
from catseye.app.results.scara.scan import SCAN_ROWS, identify_scan_file
from catseye.app.results.scara.stated_budget import BudgetChoice, budget_of_table
from catseye.app.results.scara.uncertainty import Propagated, by_jacobian, by_monte_carlo, require_draws
from catseye.calibration.core.contributions import Contributions
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.layout import ModelName
from catseye.procedures.scara.bench import ScaraBench


@dataclass(frozen=True)
class MonteCarlo:
    """Draws that carry the uncertainties through the identification.

    Attributes:
        draws: how many.
        seed: of the draws.

    Raises:
        UsageError: they are too few to say anything.
    """

    draws: int
    seed: int

    def __post_init__(self) -> None:
        require_draws(self.draws)


@dataclass(frozen=True)
class Method:
    """How to identify.

    Attributes:
        model: which model.
        loss: how much far-off distances count: "squares", "huber" or "soft-l1".
        reject: distances beyond so many robust standard deviations are left out; None for none.
        extend: terms beyond the model, as the command line names them.
        monte_carlo: how uncertainties are propagated; None for the Jacobian.
        accept_implausible: why an implausible arm is kept; None refuses it.

    Raises:
        UsageError: a loss that no Monte Carlo can take its uncertainties from, or no reason to accept what is
            implausible.
    """

    model: ModelName
    loss: str = "squares"
    reject: float | None = None
    extend: tuple[str, ...] = ()
    monte_carlo: MonteCarlo | None = None
    accept_implausible: str | None = None

    def __post_init__(self) -> None:
        if self.accept_implausible is not None and not self.accept_implausible.strip():
            raise UsageError("--accept-implausible needs a reason: say why the result is kept")
        if self.loss != "squares" and self.monte_carlo is not None:
            raise UsageError(
                f"--loss {self.loss} takes its uncertainties from the scatter of the distances; Monte Carlo draws "
                "are identified by least squares: use --reject K with --uncertainty monte-carlo, or "
                "--uncertainty jacobian"
            )


def identified(
    source: DistanceSource, method: Method, sharing: Callable[[], AbstractContextManager[Share]]
) -> Result:
    """Identify from distances.

    Args:
        sharing: provides who shares the draws of a Monte Carlo.
    """
    bench, terms = source.bench, parse_extensions(method.extend)
    problem = problem_of_points(source.points, bench, method.model, source.stated.budget, terms)
    with failures_explained(problem, bench.plausibility):
        found, contributions = identify_robustly(problem, method.loss, method.reject)
    implausible = require_plausible(problem, found, bench.plausibility, method.accept_implausible)
    propagated = _propagated(found, contributions, method, sharing)
    result = identified_result(
        propagated.identified, bench, source.names, source.stated.part, source.stated.simulated
    )
    result = with_what_speaks_against(with_reference_links(result, source.readers), source.stated.unverified)
    return result.model_copy(
        update={
            "uncertainty": propagated.part,
            "implausible": implausible,
            "provenance": result.provenance.model_copy(
                update={"interferometer": interferometer_of(source.readers)}
            ),
        }
    )


def _propagated(
    identification: Identification,
    contributions: Contributions | None,
    method: Method,
    sharing: Callable[[], AbstractContextManager[Share]],
) -> Propagated:
    wanted = method.monte_carlo
    if wanted is None:
        return by_jacobian(identification, contributions)
    bar = ProgressBar("Monte Carlo")
    with sharing() as share:
        try:
            return by_monte_carlo(
                identification,
                wanted.draws,
                wanted.seed,
                share,
                lambda done: bar.update(done, wanted.draws, f"{done} of {wanted.draws} draws"),
            )
        finally:
            bar.close()


def identified_scan(
    points: Path, cell: Path, method: Method, budget: BudgetChoice | None, *, unverified: bool
) -> tuple[Result, ScaraBench]:
    """Identify from a long points file, with bars for reading and for solving.

    Args:
        budget: which error budget counts; None for the table's own, else the cell's.
        unverified: take a table too that was changed.

    Raises:
        UsageError: an option is asked for that needs all distances at once, or a file is wrong.
    """
    _require_streamable(points, method)
    loaded = load_cell(cell).cell
    bench = scara_bench_of(loaded)
    terms = with_gears(parse_extensions(method.extend), bench, method.model)
    with _Bar("reading") as reading, _Bar("solving") as solving:
        result = identify_scan_file(
            points,
            bench,
            method.model,
            lambda seen: budget_of_table(seen, loaded.uncertainty, cell.name, budget, unverified=unverified),
            terms,
            lambda share: reading.update(share, 1.0, points.name),
            lambda done, expected: solving.update(done, expected, f"{done} of {expected} rows"),
            method.accept_implausible,
        )
    return result, bench


def _require_streamable(points: Path, method: Method) -> None:
    asked = [
        name
        for name, given in (
            ("--uncertainty monte-carlo", method.monte_carlo is not None),
            (f"--loss {method.loss}", method.loss != "squares"),
            ("--reject", method.reject is not None),
        )
        if given
    ]
    if asked:
        raise UsageError(
            f"{points}: is streamed, as files of more than {SCAN_ROWS} distances are, and {', '.join(asked)} "
            "needs all distances at once: leave it out, or thin the points (every tenth row, say) into a CSV file"
        )


class _Bar:
    """A progress bar whose time begins with the first thing that it shows."""

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
