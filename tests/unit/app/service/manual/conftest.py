"""What several tests of the bench begin with."""

import pytest

from catseye.app.cell.model import Cell
from tests.unit.app.service.manual.benches import cell_from_template


@pytest.fixture(scope="session")
def cell() -> Cell:
    return cell_from_template()
