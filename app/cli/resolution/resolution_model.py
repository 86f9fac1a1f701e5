"""resolution-model: from results of motion resolution to look-up tables."""

from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, Dask, InsecureCluster, Output, Workers
from catseye.app.cli.output import note, write_document
from catseye.app.cli.progress import ProgressBar
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.cluster.sharing import sharing
from catseye.app.files.atomic import require_output


def resolution_model(
    result: Annotated[
        list[Path], typer.Argument(metavar="RESULT...", help="results of catseye resolution for one arm")
    ],
    output: Output,
    workers: Workers = 1,
    dask: Dask = None,
    insecure_cluster: InsecureCluster = False,
    as_json: AsJson = False,
) -> None:
    """Make look-up tables of step errors of joints. The data are results of catseye resolution.

    Example: catseye resolution-model a1.json a2.json a3.json -o tables.csv
    """
    from catseye.app.results.resolution.joint_tables import write_joint_tables
    from catseye.app.results.resolution.modelling import model_arm, model_document, model_report

    require_output(output, *result)
    with sharing(workers, dask, insecure=insecure_cluster) as share, closing(ProgressBar("models")) as bar:
        modelled = model_arm(result, share, lambda n, of: bar.update(n, of, f"{n} of {of} models"))
    write_joint_tables(modelled.tables, output, simulated=modelled.simulated)
    report = model_report(modelled)
    if as_json:
        write_document("joint-models", model_document(modelled, output).json_object())
    else:
        write_tables(report)
    note_statements(report)
    note(f"{output} written")
