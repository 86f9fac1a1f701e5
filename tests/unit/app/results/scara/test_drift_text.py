"""What a result says of a drift."""

from typing import Any

import pytest

from catseye.app.results.scara.drift_text import drift_part, drift_statements
from catseye.app.results.scara.result import Result
from catseye.calibration.scara.budget import Contributor
from catseye.calibration.scara.found_drift import FoundDrift
from tests.unit.app.results.scara.sample import results

ZERO = FoundDrift(Contributor("zero", "length", 0.002, "time"), 0.008, 0.003, 0.0162, 0.0019, 1e-9)
LINKS = FoundDrift(Contributor("warmth", "links", 2e-6, "time"), -9.7e-6, 1.6e-6, 3.3e-6, 5e-7, 1e-9)


def texts(*found: FoundDrift) -> list[str]:
    sample: Result = results()[0]
    stated: dict[str, Any] = {"drift": [drift_part(one) for one in found]}
    read = Result.model_validate_json(sample.model_copy(update=stated).model_dump_json())
    return [statement.text for statement in drift_statements(read)]


@pytest.mark.parametrize(
    ("found", "said"),
    [
        (ZERO, "The zero drifted by 16.2 ± 3.8 µm rms during the measurement"),
        (LINKS, "The links shrank by 9.7 ± 3.2 ppm (k = 2) from first to last row"),
    ],
)
def test_what_was_found_is_said_with_its_uncertainty(found: FoundDrift, said: str) -> None:
    (text,) = texts(found)
    assert text.startswith(said)
    assert text.endswith(f"({found.contributor.name}).")


def test_what_scatter_explains_is_not_said() -> None:
    calm = FoundDrift(ZERO.contributor, 0.0, 0.003, 0.0003, 0.0006, 0.5)
    assert texts(calm) == []
