"""identify: from distances to an arm."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from catseye.app.cli.options import (
    AcceptImplausible,
    AsJson,
    Budget,
    Dask,
    InsecureCluster,
    MeasuredRuns,
    PointsCell,
    PointsFile,
    Runs,
    Unverified,
    Workers,
)
from catseye.app.cli.output import note, warn, write_document
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.cluster.sharing import sharing
from catseye.app.files.atomic import require_output

if TYPE_CHECKING:
    from catseye.app.results.scara.result import Result


def identify(
    output: Annotated[Path, typer.Option("-o", "--output", help="result JSON to write")],
    run: MeasuredRuns = None,
    points: PointsFile = None,
    cell: PointsCell = None,
    model: Annotated[
        Literal["conventional", "error-map"], typer.Option(help="model to identify")
    ] = "error-map",
    budget: Budget = None,
    uncertainty: Annotated[
        Literal["jacobian", "monte-carlo"], typer.Option(help="how to propagate uncertainties")
    ] = "jacobian",
    draws: Annotated[int, typer.Option(help="number of Monte Carlo draws, at least 2000")] = 10_000,
    seed: Annotated[int, typer.Option(min=0, help="seed of the Monte Carlo draws")] = 1,
    loss: Annotated[
        Literal["squares", "huber", "soft-l1"],
        typer.Option(help="weight of outlying distances: huber and soft-l1 reduce it"),
    ] = "squares",
    reject: Annotated[
        float | None,
        typer.Option(
            metavar="K",
            min=2.0,
            help="leave out distances that deviate by more than K robust standard deviations",
        ),
    ] = None,
    extend: Annotated[
        list[str] | None,
        typer.Option(
            metavar="TERMS",
            help="further terms: crosstalk, j4, thermal, periodic1:ORDER, periodic2:ORDER; may be repeated",
        ),
    ] = None,
    accept_implausible: AcceptImplausible = None,
    workers: Workers = 1,
    dask: Dask = None,
    insecure_cluster: InsecureCluster = False,
    runs: Runs = None,
    unverified: Unverified = False,
    as_json: AsJson = False,
) -> None:
    """Identify links and error maps from distances.

    Example: catseye identify --points points.csv --cell cell.toml -o result.json
    """
    from catseye.app.cli.scara.identifying import Method, MonteCarlo, identified, identified_scan
    from catseye.app.cli.scara.refusal import refusal_as_json
    from catseye.app.results.scara.distances import load_distances
    from catseye.app.results.scara.scan import is_scan
    from catseye.app.store.unverified import taken_as_it_is

    require_output(output, points, cell)
    monte_carlo = MonteCarlo(draws, seed) if uncertainty == "monte-carlo" else None
    method = Method(model, loss, reject, tuple(extend or ()), monte_carlo, accept_implausible)
    with refusal_as_json(as_json=as_json):
        if points is not None and cell is not None and not run and is_scan(points):
            result, _ = identified_scan(points, cell, method, budget, unverified=unverified)
        else:
            source = load_distances(run or [], points, cell, runs, unverified, budget)
            for text in source.warnings:
                warn(text)
            with taken_as_it_is(*source.readers):
                result = identified(
                    source, method, partial(sharing, workers, dask, insecure=insecure_cluster)
                )
    _hand_over(result, output, as_json=as_json)


def _hand_over(result: "Result", output: Path, *, as_json: bool) -> None:
    """Write a result and show it."""
    from catseye.app.results.scara.identification_document import identification_document
    from catseye.app.results.scara.identification_report import identification_report
    from catseye.app.results.scara.result import write_result

    write_result(result, output)
    report = identification_report(result)
    if as_json:
        write_document("identification", identification_document(result, output))
    else:
        write_tables(report)
    note_statements(report)
    note(f"{output} written")
