"""What doctor says about a length counter without moving anything."""

import pytest

from catseye.app.service.examination import assumed_count

_ASSUMED = "assumed, not checked since nothing moves: "


@pytest.mark.parametrize(
    ("count_mm", "text"),
    [
        (1.0, "the instrument's number grows while the beam grows longer, and 1 in it is 1 mm"),
        (-25.4, "the instrument's number grows while the beam grows shorter, and 1 in it is 25.4 mm"),
        (
            316.4954e-6,
            "the instrument's number grows while the beam grows longer, and 1 in it is 316.4954 nm",
        ),
        (None, "displacements grow with the beam and are in mm, as the driver gives them"),
    ],
)
def test_sign_and_scale_are_said_in_words(count_mm: float | None, text: str) -> None:
    assert assumed_count(count_mm) == _ASSUMED + text
