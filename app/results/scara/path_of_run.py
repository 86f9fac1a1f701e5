"""A stored validation path against the models of the measurement it belongs to."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.protocol.procedures import analysed_by
from catseye.app.results.runs.run_source import are_simulated
from catseye.app.results.scara.distance_validation import DistanceValidation, validate_on_distances
from catseye.app.results.scara.identify import (
    MODELS,
    bench_of_runs,
    identified_result,
    identify_points,
    run_points,
)
from catseye.app.results.scara.material import with_reference_links
from catseye.app.results.scara.mirrored import mirrored_text
from catseye.app.results.scara.path_rows import distance_path, holds_distances, path_measurement
from catseye.app.results.scara.plausible import ImplausibleError
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.stated_budget import budget_of_runs
from catseye.app.results.scara.validation import PathValidation, validate_on_path
from catseye.app.store.catalog import list_runs
from catseye.app.store.reader import Accept, RunReader
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.scara.identification import Identification
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.records import Distance, PathPosition


@dataclass(frozen=True)
class PathComparison:
    """What can be said about a stored path.

    Attributes:
        notes: which measurement the models come from, or why there is nothing to compare with.
        results: both models.
        validation: on the positions of an independent instrument.
        distances: on distances of the interferometer.
    """

    notes: list[str]
    results: list[Result] = field(default_factory=list)
    validation: PathValidation | None = None
    distances: DistanceValidation | None = None


def compare_path(reader: RunReader, root: Path) -> PathComparison:
    """Compare a run of validation-path with the models of the newest complete open-loop run of the same bench."""
    measured = _measurement(reader, root)
    if measured is None:
        return PathComparison(
            [
                "the path is compared with nothing: there is no complete open-loop run of this cell with the same "
                f"aim ({reader.meta.get('aim')}); measure one and report again"
            ]
        )
    try:
        return compare_with(reader, [measured], root)
    except (CalibrationError, ImplausibleError, UsageError) as error:
        return PathComparison(
            [f"the path cannot be compared with the models of {measured.path.name}: {error}"]
        )


def compare_with(reader: RunReader, measured: Sequence[RunReader], root: Path) -> PathComparison:
    """Compare a run of validation-path with both models, identified from runs of distances.

    Raises:
        CalibrationError: the distances do not determine a model, or too little of the path can be compared.
        ImplausibleError: a model cannot be the arm that was measured.
        UsageError: the runs do not belong together, or the path is to a reflector that they do not know.
    """
    bench, stated = bench_of_runs(measured, root), budget_of_runs(measured)
    points, names = run_points(measured), [each.path.name for each in measured]
    identified = [identify_points(points, bench, model, stated.budget) for model in MODELS]
    found = _compared(reader, identified, bench)
    results = [
        identified_result(identification, bench, names, stated.part, are_simulated(measured))
        for identification in identified
    ]
    notes = [f"the models on the path were identified from {', '.join(names)}", *found.notes]
    return PathComparison(
        notes,
        [with_reference_links(result, measured) for result in results],
        found.validation,
        found.distances,
    )


def _compared(reader: RunReader, identified: list[Identification], bench: ScaraBench) -> PathComparison:
    if holds_distances(reader.rows(PathPosition.table)):
        distances = validate_on_distances(distance_path(reader, bench.take_up_deg), identified)
        return PathComparison(list(distances.rejected), distances=distances)
    nominal = (bench.link1_mm, bench.link2_mm)
    path = path_measurement(reader, bench.take_up_deg)
    arms = [identification.arm for identification in identified]
    validation = validate_on_path(path, arms, nominal)
    mirrored = mirrored_text(validation)
    return PathComparison([mirrored] if mirrored else [], validation=validation)


def _measurement(reader: RunReader, root: Path) -> RunReader | None:
    wanted, measuring = _bench_key(reader), {each.name for each in analysed_by("identify")}
    for run in reversed(list_runs(root)):
        if run.procedure in measuring and run.status == "complete":
            found = RunReader(run.path, Accept.UNCHECKED)
            if _bench_key(found) == wanted and found.count(Distance.table):
                return reader.beside(run.path)
    return None


def _bench_key(reader: RunReader) -> tuple[object, ...]:
    """Return what two runs of one bench have in common."""
    meta = reader.meta
    return meta.get("cell"), meta.get("aim"), bool(meta.get("simulated"))
