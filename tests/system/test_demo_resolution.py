"""The demonstration of motion resolution on its emulated bench, with fewer steps."""

from pathlib import Path

import pytest

from catseye.app.cli.demonstration import Demonstration
from catseye.app.cli.resolution.demo import evaluate, measure, result_file
from catseye.app.engine.announcer import Publish
from catseye.app.protocol.events import AnyEvent
from catseye.app.results.resolution.result import read_resolution


def silent(procedure: str) -> Publish:
    del procedure

    def publish(event: AnyEvent) -> None:
        del event

    return publish


@pytest.mark.slow
async def test_the_demo_finds_steps_of_an_emulated_joint(tmp_path: Path) -> None:
    given = Demonstration(tmp_path, 4.0, 2, None, silent)
    short = ("standstill_s=15", "dwell_s=1.5", 'joints=["A1"]', 'positions=["K3"]', "directions=[-1]")
    runs = await measure(given, [("resolution", (*short, "first_deg=0.05", "steps=12"))])
    evaluate(given, runs)
    (test,) = read_resolution(result_file(given)).tests
    assert (test.test, test.joint, test.direction) == ("decaying", "A1", -1)
    errors = [move.error_percent for move in test.moves]
    # Steps a hundred times those that the paper found to be lost are made whole.
    assert len(errors) == 12
    assert all(error is not None and abs(error) < 5.0 for error in errors)
    assert given.truth_file.is_file()
