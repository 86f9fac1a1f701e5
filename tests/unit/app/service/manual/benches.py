"""The bench of the cell file that `catseye init` writes."""

import tomllib

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.protocol.engine_events import BenchSeen, Client
from catseye.app.service.watching.bench_facts import facts_of
from catseye.app.service.watching.bench_status import bench_status
from catseye.app.service.watching.latest_values import LatestValues
from catseye.procedures.scara.bench import ScaraBench
from tests.unit.app.engine.fakes import ManualClock


def cell_from_template() -> Cell:
    return Cell.model_validate(tomllib.loads(TEMPLATE))


def bench_from_template() -> ScaraBench:
    return scara_bench_of(cell_from_template())


def bench_seen(*, disk_free_bytes: int | None = None) -> BenchSeen:
    """Return the event of a bench of which nothing but the cell file is known."""
    facts, latest = facts_of(cell_from_template(), bench_from_template()), LatestValues(ManualClock())
    status = bench_status(facts, latest, moving=False, simulated=None, free_bytes=disk_free_bytes)
    return BenchSeen(**dict(status))


def client(who: str = "Ada") -> Client:
    return Client(client="test-1", who=who)
