"""What the tests of jobs share."""

from pathlib import Path

import pytest

from tests.unit.app.campaign.night import Night


@pytest.fixture
def night(tmp_path: Path) -> Night:
    """Return a cell of three stages."""
    return Night(tmp_path)
