"""A result against a path that the interferometer measured: predicted against measured distances."""

from dataclasses import replace
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.results.model import Report
from catseye.app.results.origin import joined
from catseye.app.results.runs.run_source import origin_of_run
from catseye.app.results.said import said
from catseye.app.results.scara.arm_report import arm_report
from catseye.app.results.scara.distance_report import distance_statement
from catseye.app.results.scara.distance_validation import DistanceValidation
from catseye.app.results.scara.findings import Findings
from catseye.app.results.scara.path_of_run import PathComparison, compare_with
from catseye.app.results.scara.path_rows import holds_distances
from catseye.app.results.scara.result import Result, read_result
from catseye.app.results.scara.validation_document import DistanceValidationDocument, ModelOnDistancesPart
from catseye.app.results.scara.values import result_values
from catseye.app.store.reader import RunReader
from catseye.procedures.scara.records import PathPosition

_SAME_SHARE = 0.01
"""Of its uncertainty: values that differ by less come from the same points, the same options and the same model."""


def has_distances(reader: RunReader) -> bool:
    """Return whether a run has measured a path by distances."""
    return bool(reader.count(PathPosition.table)) and holds_distances(reader.rows(PathPosition.table))


def conventional_beside(result: Path) -> Path | None:
    """Return the conventional model that was identified from the same runs as an error map, and lies beside it."""
    known, beside = read_result(result), sorted(result.absolute().parent.glob("*.json"))
    return next((path for path in beside if _is_conventional_of(path, known)), None)


def is_conventional_of(path: Path, result: Path) -> bool:
    """Return whether a file is the conventional model that was identified from the same runs as an error map."""
    return _is_conventional_of(path, read_result(result))


def _is_conventional_of(path: Path, known: Result) -> bool:
    try:
        other = read_result(path)
    except UsageError:
        return False
    return (known.model, other.model) == ("error-map", "conventional") and bool(
        known.provenance.runs and other.provenance.runs == known.provenance.runs
    )


def validate_run(result: Path, reader: RunReader) -> PathComparison:
    """Compare a result, and before it the conventional model of its runs, with the distances of another run.

    Args:
        reader: of the path; the runs that the result was identified from are looked for beside it.

    Raises:
        UsageError: the result comes from no runs there, or not from these runs by default options.
        CalibrationError: too little of the path can be compared.
    """
    known, root = read_result(result), reader.path.parent
    names = known.provenance.runs
    missing = [name for name in names if not (root / name).is_dir()]
    if missing or not names:
        raise UsageError(
            f"{result} was identified from {', '.join(missing) or 'no runs'}, which {root} does not hold: distances "
            "along a path are compared with models of runs beside it; copy the runs there"
        )
    found = compare_with(reader, [reader.beside(root / name) for name in names], root)
    place = [one.model for one in found.results].index(known.model)
    again = found.results[place]
    if not _are_the_same(known, again):
        raise UsageError(
            f"{result} is not what {', '.join(names)} give with default options, and distances along a path are "
            f"compared with those: identify them again without options, or read catseye report {reader.path.name}"
        )
    if found.distances is None:
        raise UsageError(f"{reader.path.name} holds positions along a path, not distances")
    models = found.distances.models[: place + 1]
    return replace(
        found, results=found.results[: place + 1], distances=replace(found.distances, models=models)
    )


def distance_report(found: PathComparison, reader: RunReader) -> Report:
    """Return what the models leave on the distances of a run."""
    origin = joined([*(one.provenance.origin for one in found.results), origin_of_run(reader)])
    findings = Findings(found.results, distances=found.distances)
    return arm_report(f"Validation on {reader.path.name}", origin, findings)


def distance_document(found: DistanceValidation, limit_um: float | None) -> DistanceValidationDocument:
    """Return what was found as plain values.

    Args:
        limit_um: rms that may be left.
    """
    left_um = found.models[-1].rms_um
    return DistanceValidationDocument(
        rows=int(found.compared.size),
        compared=int(found.compared.sum()),
        left_out=list(found.rejected),
        models=[ModelOnDistancesPart.model_validate(model) for model in found.models],
        ratio=found.ratio,
        limit_um=limit_um,
        within_limit=None if limit_um is None else left_um <= limit_um,
        said=said([distance_statement(found)]),
    )


def _are_the_same(one: Result, other: Result) -> bool:
    mine, others = ({each.name: each for each in result_values(result)} for result in (one, other))
    return mine.keys() == others.keys() and all(
        abs(each.value - others[name].value) <= _SAME_SHARE * max(each.u, others[name].u)
        for name, each in mine.items()
    )
