"""A finished validation stands in the dossier by what the result leaves on the run."""

import re
from pathlib import Path

import numpy as np
import pytest

from catseye.app.results.dossier.validated import worth_of_validation
from catseye.app.results.model import Sign
from catseye.app.store.reader import RunReader
from tests.unit.app.test_path_comparison import identified, positions, stored


def leaves_um(figure: str) -> float:
    """Return what the last model leaves."""
    found = re.search(r"the error map leaves ([\d.]+) µm", figure)
    assert found is not None
    return float(found[1])


async def on_run(folder: Path, rows: str) -> tuple[RunReader, Path]:
    by_distances, result = await identified(folder)
    if rows == "distances":
        return by_distances, result
    return await stored(folder / "runs", "validation-path", positions()), result


@pytest.mark.parametrize("rows", ["distances", "positions"])
async def test_the_true_arm_leaves_nothing_on_its_path(tmp_path: Path, rows: str) -> None:
    reader, result = await on_run(tmp_path, rows)
    worth = worth_of_validation(result, reader)
    # The run comes from the arm that was measured, without noise.
    assert np.isclose(leaves_um(worth.figure), 0.0, atol=0.1)
    assert worth.sign is not Sign.BAD
    assert len(worth.sections) == 1
    assert worth.sections[0].blocks
    assert any(origin.simulated for origin in worth.origins)
