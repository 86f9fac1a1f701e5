"""The demonstration of motion resolution on its emulated bench, with fewer steps."""

from pathlib import Path

import pytest

from catseye.app.cli.demonstration import Demonstration
from catseye.app.cli.resolution.demo import compared_with_truth, evaluate, measure, report_of, shipped_file
from catseye.app.engine.announcer import Publish
from catseye.app.protocol.events import AnyEvent
from catseye.app.render.page import write_page
from catseye.app.results.resolution.result import read_resolution


def silent(procedure: str) -> Publish:
    del procedure

    def publish(event: AnyEvent) -> None:
        del event

    return publish


SHORT = (
    "resolution",
    (
        "standstill_s=15",
        "dwell_s=1.5",
        'joints=["A1"]',
        'positions=["K3"]',
        "directions=[-1]",
        "first_deg=0.05",
        "steps=12",
    ),
)


@pytest.mark.slow
async def test_the_demo_finds_steps_of_an_emulated_joint(tmp_path: Path) -> None:
    # Slower than the demonstration of a user: a machine that runs a whole suite is busy.
    given = Demonstration(tmp_path, 8.0, 1, None, silent)
    runs = await measure(given, [SHORT])
    result = evaluate(given, runs)
    (test,) = result.tests
    assert (test.test, test.joint, test.position, test.direction) == ("decaying", "A1", 0.0, -1)
    errors = [move.error_percent for move in test.moves]
    # Steps a hundred times those that the paper found to be lost are made whole.
    assert len(errors) == 12
    assert all(error is not None and abs(error) < 5.0 for error in errors)

    (true,) = compared_with_truth(given, runs, result)
    assert true.true_deg == pytest.approx(0.05 / 1.072267**11)

    shipped = read_resolution(shipped_file(given)).tests
    assert all(one.shipped for one in shipped)
    places = {(one.joint, one.position, one.direction) for one in shipped if one.test == "decaying"}
    assert len(places) == 59
    assert ("A1", 0.0, -1) not in places

    page = tmp_path / "report.html"
    write_page(report_of(given, [true]), page)
    text = page.read_text(encoding="utf-8")
    assert "SIMULATION" in text
    assert "shipped" in text
