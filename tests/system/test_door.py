"""The door is opened while the arm moves: STOP comes first, and nothing moves before somebody agrees."""

from pathlib import Path

from tests.system.command import emulated
from tests.system.door_openings import SLOW, open_at_random, require_acknowledged

_OPENINGS = 3
_SPEED = 5


def test_every_opening_is_a_stop_and_an_acknowledgement(tmp_path: Path) -> None:
    with emulated(tmp_path, "--speed", str(_SPEED), edit=SLOW) as bench:
        openings, records = open_at_random(bench, tmp_path, _OPENINGS, seed=5, speed=_SPEED)
    assert len(openings) == _OPENINGS
    assert [opening.motions for opening in openings] == [0] * _OPENINGS
    assert sum(map(require_acknowledged, records)) >= _OPENINGS
    assert all(len(record.rows("points")) == 16 + 2 for record in records)
