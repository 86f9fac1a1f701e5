"""identify: from distances to an arm."""

from dataclasses import dataclass
from pathlib import Path

from catseye.app.cluster.sharing import sharing
from catseye.app.commands.identify_scan import identified_scan
from catseye.app.commands.output import emit, emit_json, say
from catseye.app.commands.progress import ProgressBar
from catseye.app.errors import UsageError
from catseye.app.files.result_json import Result, write_result
from catseye.app.render.text import statement_lines, tables_text
from catseye.app.results.scara.distances import DistanceSource, load_distances
from catseye.app.results.scara.extensions import parse_extensions
from catseye.app.results.scara.identification_report import identification_report
from catseye.app.results.scara.identify import (
    are_simulated,
    identified_result,
    problem_of_rows,
    with_what_speaks_against,
)
from catseye.app.results.scara.material import with_reference_links
from catseye.app.results.scara.robust import identify_robustly
from catseye.app.results.scara.scan import is_scan
from catseye.app.results.scara.uncertainty import (
    Propagated,
    by_jacobian,
    by_monte_carlo,
    require_draws,
)
from catseye.app.store.unverified import taken_as_it_is
from catseye.calibration.identification import Identification
from catseye.calibration.layout import ModelName
from catseye.calibration.uncertainty.contributions import Contributions


@dataclass(frozen=True)
class IdentifyOptions:
    """How to identify.

    Attributes:
        model: which model.
        uncertainty: "jacobian" or "monte-carlo".
        draws: of a Monte Carlo.
        seed: of its draws.
        loss: how much far-off distances count: "squares", "huber" or "soft-l1".
        reject: distances beyond so many robust standard deviations are left out; None for none.
        extend: terms beyond the model, as the command line names them.
        workers: processes that share the draws; 0 takes one a core.
        dask: address of a scheduler whose machines share them.
        insecure_cluster: the scheduler may be outside of this machine, and the connection without TLS.
        unverified: take sealed runs too whose files were changed; the result says so.
    """

    model: ModelName
    uncertainty: str
    draws: int
    seed: int
    loss: str = "squares"
    reject: float | None = None
    extend: tuple[str, ...] = ()
    workers: int = 1
    dask: str | None = None
    insecure_cluster: bool = False
    unverified: bool = False


def identify_command(
    output: Path,
    run: list[str],
    points: Path | None,
    cell: Path | None,
    options: IdentifyOptions,
    runs: Path | None,
    as_json: bool,
) -> None:
    """Identify and write the result."""
    if options.uncertainty == "monte-carlo":
        require_draws(options.draws)
    _require_consistent(options)
    if points is not None and cell is not None and not run and is_scan(points):
        result, _ = identified_scan(points, cell, options)
        _hand_over(result, output, as_json=as_json)
        return
    source = load_distances(run, points, cell, runs, options.unverified)
    for text in source.warnings:
        say(text)
    with taken_as_it_is(*source.readers):
        result = _identified(source, options)
    _hand_over(result, output, as_json=as_json)


def _identified(source: DistanceSource, options: IdentifyOptions) -> Result:
    bench, terms = source.bench, parse_extensions(options.extend)
    problem = problem_of_rows(source.rows, bench, options.model, source.budget, terms)
    propagated = _propagated(*identify_robustly(problem, options.loss, options.reject), options)
    result = with_reference_links(
        identified_result(propagated.identified, bench, source.names, are_simulated(source.readers)),
        source.readers,
    )
    return with_what_speaks_against(result, source.readers).model_copy(
        update={"uncertainty": propagated.part}
    )


def _hand_over(result: Result, output: Path, *, as_json: bool) -> None:
    """Write a result and show it."""
    write_result(result, output)
    report = identification_report(result)
    if as_json:
        emit_json(
            {
                "result": str(output),
                **result.model_dump(include={"model", "gauge", "link1_mm", "link2_mm", "extension", "fit"}),
            }
        )
    else:
        emit(tables_text(report))
    for line in statement_lines(report):
        say(line)
    say(f"{output} written")


def _require_consistent(options: IdentifyOptions) -> None:
    if options.loss != "squares" and options.uncertainty == "monte-carlo":
        raise UsageError(
            f"--loss {options.loss} takes its uncertainties from the scatter of the distances; Monte Carlo draws are "
            "identified by least squares: use --reject K with --uncertainty monte-carlo, or --uncertainty jacobian"
        )


def _propagated(
    identified: Identification, found: Contributions | None, options: IdentifyOptions
) -> Propagated:
    if options.uncertainty == "jacobian":
        return by_jacobian(identified, found)
    bar = ProgressBar("Monte Carlo")
    with sharing(options.workers, options.dask, insecure=options.insecure_cluster) as share:
        try:
            return by_monte_carlo(
                identified,
                options.draws,
                options.seed,
                share,
                lambda done: bar.update(done, options.draws, f"{done} of {options.draws} draws"),
            )
        finally:
            bar.close()
