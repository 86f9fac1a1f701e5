"""Nights with one fault each, at a random moment: each ends by itself, and the same job called again completes.

`CATSEYE_NIGHTS` sets how many [200], `CATSEYE_SEED` repeats them, `CATSEYE_FIRST_NIGHT` begins later, and
`CATSEYE_NIGHT_S` is the deadline of each, real s [200].
"""

import os
import random
from collections import Counter
from pathlib import Path

import pytest

from tests.system.command import own_runtime
from tests.system.night_faults import FAULTS
from tests.system.nights import forget, spend

SEED = int(os.environ.get("CATSEYE_SEED", "20261127"))
NIGHTS = int(os.environ.get("CATSEYE_NIGHTS", "200"))
FIRST = int(os.environ.get("CATSEYE_FIRST_NIGHT", "0"))


@pytest.mark.timeout(600 + 2000 * NIGHTS)
def test_every_night_ends_and_the_next_completes(tmp_path: Path) -> None:
    struck: Counter[str] = Counter()
    wrong: list[str] = []
    for number in range(FIRST, FIRST + NIGHTS):
        fault = FAULTS[number % len(FAULTS)]
        folder = tmp_path / f"night-{number}"
        folder.mkdir()
        with own_runtime():
            night = spend(folder, fault, random.Random(f"{SEED}/{number}"))
        name = fault.__name__
        struck[name] += night.struck
        calls = ", ".join(f"{call.code} after {call.took_s:.0f} s" for call in night.calls)
        report(f"night {number}: {name} {'at' if night.struck else 'too late for'} {night.moment}: {calls}")
        for text in night.faults:
            report(f"    WRONG: {text}")
        wrong += [f"night {number}: {text}" for text in night.faults]
        if not night.faults:
            forget(folder)
    report(
        f"{NIGHTS} nights from {FIRST}, seed {SEED}: {len(wrong)} faults of the program; struck {dict(struck)}"
    )
    assert wrong == []


def report(text: str) -> None:
    print(text, flush=True)  # noqa: T201  # the figures
