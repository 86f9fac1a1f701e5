"""The bench and the system that a cell file describes."""

from catseye.app.cell.model import Cell
from catseye.app.cell.scara.bench import scara_bench_of
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.system import System
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.system import ScaraSystem


def bench_of(cell: Cell) -> Bench:
    """Return the bench that a cell file describes."""
    return scara_bench_of(cell)


def system_of(bench: Bench) -> System:
    """Return what there is to ask of a bench."""
    return ScaraSystem(bench) if isinstance(bench, ScaraBench) else System(bench)
