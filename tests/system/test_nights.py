"""A campaign killed while the arm measures, and another job that begins meanwhile; 200 nights: tests/campaigns."""

import random
import signal
from pathlib import Path

from catseye.app.store.catalog import paths_of
from catseye.app.store.reader import RunReader
from tests.patience import HANG_S
from tests.system.command import own_runtime
from tests.system.nights import Moment, Night, check, descendants, is_alive, lab, until

SEED = 20261127


def test_a_killed_night_goes_on_and_stays_alone(tmp_path: Path) -> None:
    rng = random.Random(SEED)
    with own_runtime(), lab(tmp_path) as place:
        night = Night(place, rng, Moment("open-loop", rng.randint(5, 100), 0.0))
        first = night.call()
        assert first.until(night.moment)
        left = descendants(first.process.pid)
        first.process.kill()
        assert first.end() == -signal.SIGKILL
        until(lambda: not any(map(is_alive, left)), HANG_S)
        again = night.call()
        assert again.until(Moment("open-loop", 0, 0.0))
        other = night.call(job="another")
        assert (other.end(), again.end()) == (4, 0)
        check(night)
    assert night.faults == []
    (run,) = paths_of(place.runs, "open-loop")
    assert [event.kind for event in RunReader(run).events()].count("run-reopened") == 1
