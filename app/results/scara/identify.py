"""From stored points to an identified arm."""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from catseye.app.cell.bench import scara_bench_of
from catseye.app.errors import UsageError
from catseye.app.results.runs.run_source import cell_of_run
from catseye.app.results.scara.budget_part import BudgetPart
from catseye.app.results.scara.drift_text import drift_part
from catseye.app.results.scara.measured_distances import measured_distances
from catseye.app.results.scara.plausible import failures_explained, require_plausible
from catseye.app.results.scara.points import point_columns, to_points
from catseye.app.results.scara.result import Covariance, Result, TakenUpPart
from catseye.app.results.scara.result_of import result_of
from catseye.app.results.scara.separated_text import separated_part
from catseye.app.results.scara.shared_errors import is_of_laser
from catseye.app.store.basis import find_basis
from catseye.app.store.reader import RunReader
from catseye.app.store.software import SOFTWARE
from catseye.calibration.scara.budget import Budget
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.extension import Term, crosstalk, j4_map, periodic, thermal_drift
from catseye.calibration.scara.found_drift import found_drifts
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.layout import ModelName
from catseye.calibration.scara.reversal import separated_orders
from catseye.procedures.kit.columns import Columns
from catseye.procedures.scara.aiming import SEARCHED
from catseye.procedures.scara.bench import Reflector, ScaraBench

_SAME_PLACE_MM = 2.0
"""Two searches find one and the same place to much better than this."""

MODELS: tuple[ModelName, ...] = ("conventional", "error-map")

_PERIODIC = re.compile(r"periodic([12]):([0-9]{1,4})")
_HIGHEST_ORDER = 2000


def run_points(readers: Sequence[RunReader]) -> Columns:
    """Return the distances of runs, returns included; a segment keeps to its own run.

    They carry no uncertainty of their own: what they are good for is the error budget's affair.

    Raises:
        UsageError: a run holds no points.
    """
    rows: list[dict[str, object]] = []
    first = 0
    for reader in readers:
        points = measured_distances(reader)
        if not points:
            raise UsageError(f"{reader.path.name} holds no points; identify needs runs of open-loop")
        rows += [{**point, "segment": first + int(str(point["segment"]))} for point in points]
        first += 1 + max(int(str(point["segment"])) for point in points)
    return point_columns(rows)


def problem_of_points(
    points: Columns,
    bench: ScaraBench,
    model: ModelName,
    budget: Budget | None,
    terms: tuple[Term, ...] = (),
) -> Problem:
    """Return what is to be solved to identify an arm from distances.

    Args:
        budget: contributors of the uncertainty; None for what the points state themselves.
        terms: beyond the model and the gears that the cell file knows of.
    """
    places = {reflector.name: (reflector.x_mm, reflector.y_mm) for reflector in bench.reflectors}
    distances = to_points(points, places)
    nodes = np.deg2rad(bench.nodes1_deg), np.deg2rad(bench.nodes2_deg)
    rough = np.array([places[name] for name in distances.reflector_names])
    links, extended = (bench.link1_mm, bench.link2_mm), with_gears(terms, bench, model)
    return Problem(distances, model, *nodes, *links, rough, budget, extended)


def with_gears(terms: tuple[Term, ...], bench: ScaraBench, model: ModelName) -> tuple[Term, ...]:
    """Return terms with the periods of the gears that the cell file knows; a model without maps has none of these."""
    if model == "conventional":
        return terms
    first, second = bench.gear_orders
    return tuple(dict.fromkeys((*periodic(1, first), *periodic(2, second), *terms)))


def identify_points(
    points: Columns, bench: ScaraBench, model: ModelName, budget: Budget | None
) -> Identification:
    """Identify an arm from distances; arguments are those of problem_of_points.

    Raises:
        CalibrationError: the points cannot determine the model; the text names what is missing.
        ImplausibleError: the arm cannot be the one that was measured.
    """
    problem = problem_of_points(points, bench, model, budget)
    with failures_explained(problem, bench.plausibility):
        found = problem.solve()
    require_plausible(problem, found, bench.plausibility)
    return found


def identified_result(
    identified: Identification,
    bench: ScaraBench,
    sources: list[str],
    budget: BudgetPart,
    simulated: bool | None = None,
) -> Result:
    """Return an identification as a result file's content."""
    nominal, now = (bench.link1_mm, bench.link2_mm), datetime.now(UTC)
    created = now.isoformat(timespec="seconds")
    result = result_of(identified, nominal, sources, SOFTWARE, created, simulated)
    budget = budget.learnt(identified.budget)
    covariance = _with_taken_up(result.covariance, identified, budget)
    drift = [drift_part(one) for one in found_drifts(identified)] or None
    j4_orders = [separated_part(one) for one in separated_orders(identified)] or None
    return result.model_copy(
        update={"budget": budget, "covariance": covariance, "drift": drift, "j4_orders": j4_orders}
    )


def _with_taken_up(
    covariance: Covariance | None, identified: Identification, budget: BudgetPart
) -> Covariance | None:
    """Return a covariance with what its parameters have taken up of the arm's and the laser's lasting errors."""
    everything = budget.everything
    if covariance is None or everything is None:
        return covariance
    found, of_arm = identified.arm.taken_up, everything.of_arm.repeating
    parts = [
        TakenUpPart(contributor=place, matrix=found[one].tolist())
        for place, one in enumerate(everything.contributors)
        if one in found and (one in of_arm or is_of_laser(one))
    ]
    return covariance.model_copy(update={"taken_up": parts})


def with_what_speaks_against(result: Result, texts: Iterable[str]) -> Result:
    """Return a result that says which of its runs and tables are not what was sealed."""
    unverified = list(dict.fromkeys(texts))
    provenance = result.provenance.model_copy(update={"unverified": unverified or None})
    return result.model_copy(update={"provenance": provenance})


def bench_of_runs(readers: Sequence[RunReader], root: Path) -> ScaraBench:
    """Return the bench that runs were made on, with the reflectors of all of them.

    Raises:
        UsageError: a run is given twice, or the runs do not belong together: other nodes or arms, one name for
            reflectors at different places, emulated and real devices.
    """
    benches = [aimed_bench(reader, root) for reader in readers]
    first = benches[0]
    _require_one_world(readers)
    for reader, bench in zip(readers, benches, strict=True):
        same = (bench.link1_mm, bench.link2_mm, bench.nodes1_deg, bench.nodes2_deg)
        if same != (first.link1_mm, first.link2_mm, first.nodes1_deg, first.nodes2_deg):
            raise UsageError(
                f"{reader.path.name} was made with other links or nodes than {readers[0].path.name}; "
                "identify them one by one"
            )
    return replace(first, reflectors=_all_reflectors(readers, benches))


def aimed_bench(reader: RunReader, root: Path) -> ScaraBench:
    """Return the bench that a run was made on, with the aim of the search it was planned with."""
    bench, source = scara_bench_of(cell_of_run(reader)), str(reader.meta.get("aim", "cell file"))
    if source == "cell file" or not (root / source).is_dir():
        return bench
    return find_basis(SEARCHED, bench, root, source, reader.beside).bench


def _require_one_world(readers: Sequence[RunReader]) -> None:
    names = [reader.path.resolve() for reader in readers]
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"{name.name} is given twice; its distances would count as independent repeats")
    if len({bool(reader.meta.get("simulated")) for reader in readers}) > 1:
        raise UsageError(
            "some of the runs were made on emulated devices and some on real ones; do not mix them"
        )


def _all_reflectors(readers: Sequence[RunReader], benches: Sequence[ScaraBench]) -> tuple[Reflector, ...]:
    found: dict[str, Reflector] = {}
    for reader, bench in zip(readers, benches, strict=True):
        for reflector in bench.reflectors:
            known = found.setdefault(reflector.name, reflector)
            if math.hypot(known.x_mm - reflector.x_mm, known.y_mm - reflector.y_mm) > _SAME_PLACE_MM:
                raise UsageError(
                    f"reflector {reflector.name} stands somewhere else in {reader.path.name} than in "
                    f"{readers[0].path.name}: a reflector that was moved needs a name of its own"
                )
    return tuple(found.values())


def parse_extensions(texts: Sequence[str]) -> tuple[Term, ...]:
    """Return the terms that words like crosstalk, j4, thermal, periodic1:36 stand for; each term once.

    Raises:
        UsageError: a word is unknown or an order is out of range.
    """
    terms = [term for text in texts for term in _terms(text)]
    return tuple(dict.fromkeys(terms))


def _terms(text: str) -> tuple[Term, ...]:
    match text:
        case "crosstalk":
            return crosstalk()
        case "j4":
            return j4_map()
        case "thermal":
            return thermal_drift()
    found = _PERIODIC.fullmatch(text)
    if found is None:
        raise UsageError(
            f"--extend {text}: unknown; possible are crosstalk, j4, thermal, and periodic1:ORDER or periodic2:ORDER "
            "with the number of periods in a turn of the joint, for example periodic1:36"
        )
    order = int(found[2])
    if not 1 <= order <= _HIGHEST_ORDER:
        raise UsageError(
            f"--extend {text}: the order has to be 1 to {_HIGHEST_ORDER} periods in a turn of the joint"
        )
    return periodic(1 if found[1] == "1" else 2, (order,))
