"""Where reflectors were found by turning J4, and the scans that found them, from a run of reflector-search."""

import numpy as np

from catseye.app.cell.bench import bench_of
from catseye.app.results.figures import Figure
from catseye.app.results.model import Section, section
from catseye.app.results.runs.run_source import cell_of_run
from catseye.app.results.scara.figures.search import Scan, scan_figure
from catseye.app.results.scara.search_section import search_section
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of, numbers_of
from catseye.procedures.scara.aiming import search_result
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.records import SeenReflector
from catseye.procedures.scara.search.reflector_search import ReflectorSearch
from catseye.procedures.scara.search.sighting import SCAN_J4, SCAN_SIGNAL


def searched_section(reader: RunReader) -> Section:
    """Return what a search has found and how; nothing of another run."""
    if reader.meta.get("procedure") != ReflectorSearch.name:
        return section("search", "Reflector search", [])
    search = search_result(reader)
    found = search_section([] if search is None else [search])
    return section(found.key, found.title, [*found.blocks, _scans(reader)], brief=True)


def _scans(reader: RunReader) -> Figure | None:
    """Return the newest scan of each reflector; None where nobody scanned."""
    looked = [step for step in reader.steps() if SCAN_J4 in step.result]
    if not looked:
        return None
    bench = bench_of(cell_of_run(reader))
    if not isinstance(bench, ScaraBench):
        raise TypeError("reflectors are searched on a SCARA only")
    names = [reflector.name for reflector in bench.reflectors]
    seen = {row["step_id"]: row for row in reader.rows(SeenReflector.table)}
    scans: dict[str, Scan] = {}
    for step in reversed(looked):
        name = str(step.result["reflector"])
        if name not in scans:
            scans[name] = _scan(names.index(name), step.result, seen.get(step.step_id))
    return scan_figure(list(scans.values()), bench.optics.signal_min)


def _scan(place: int, looks: Row, seen: Row | None) -> Scan:
    j4_deg, signal = (np.array(numbers_of(looks, key)) for key in (SCAN_J4, SCAN_SIGNAL))
    theta1_deg, theta2_deg = (number_of(looks, key) for key in ("theta1_deg", "theta2_deg"))
    edges = None
    if seen is not None:
        lower, middle, upper = (number_of(seen, key) for key in ("lower_deg", "j4_deg", "upper_deg"))
        edges = lower, middle, upper
    return Scan(str(looks["reflector"]), place, theta1_deg, theta2_deg, j4_deg, signal, edges)
