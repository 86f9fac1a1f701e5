"""How far the arm travels until STOP is written, reckoned by hand."""

from math import radians

from catseye.app.service.examination import stopping_text
from tests.unit.procedures.benches import bench


def test_travel_until_stop_is_that_of_the_farthest_body() -> None:
    # Outstretched, all joints at full speed in the same direction; the head reaches 60 mm beyond the J4 axis.
    speed_mm_s = 0.2 * (radians(420.0) * 610.0 + radians(720.0) * 285.0 + radians(3000.0) * 60.0 + 1100.0)
    text = stopping_text(bench(), 20.0)
    assert f"faster than {speed_mm_s:.0f} mm/s" in text
    assert f"the program killed {0.1 * speed_mm_s:.0f} mm" in text
    assert f"the program stopped or blocked {0.7 * speed_mm_s:.0f} mm" in text
