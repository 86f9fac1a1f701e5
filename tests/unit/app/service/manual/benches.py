"""The bench of the cell file that `catseye init` writes."""

import tomllib

from catseye.app.cell.bench import bench_of
from catseye.app.cell.model import Cell
from catseye.app.cell.template import TEMPLATE
from catseye.procedures.kit.bench import Bench


def cell_from_template() -> Cell:
    return Cell.model_validate(tomllib.loads(TEMPLATE))


def bench_from_template() -> Bench:
    return bench_of(cell_from_template())
