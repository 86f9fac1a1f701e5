"""Two programs that want the same arm at the same time."""

import random
import time
from dataclasses import dataclass

from tests.system.command import Emulated
from tests.system.guarded import measuring, requests, until


@dataclass(frozen=True)
class Race:
    """How a race of two ended.

    Attributes:
        refused: programs that were refused with exit code 3 and the name of the owner.
        switched_on: how many switched the drives on, which is what a run does before it moves anything.
        took_right: how often the operation right was taken.
    """

    refused: int
    switched_on: int
    took_right: int


def race(bench: Emulated, moments: random.Random) -> Race:
    """Start two measurements at nearly the same time, and end the one that moves the arm."""
    begun_s = float(bench.ask(op="state")["time_s"])
    with measuring(bench) as one:
        time.sleep(moments.uniform(0.0, 0.3))
        with measuring(bench) as other:
            both = (one, other)
            until(lambda: any(each.process.poll() is not None for each in both))
            until(lambda: one.moving or all(each.process.poll() is not None for each in both))
            ends = [each.ended() for each in both if each.process.poll() is not None]
            words = [word for time_s, word in requests(bench) if time_s > begun_s]
    refused = sum(code == 3 and "in use by process" in stderr for code, stderr in ends)
    return Race(refused, words.count("SRVON"), words.count("CNTLON"))
