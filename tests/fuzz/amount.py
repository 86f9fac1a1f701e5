"""How much is tried: little in the suite, much in `make campaign-fuzz`.

CATSEYE_FUZZ_BYTES   bytes into each codec
CATSEYE_FUZZ_FILES   mutated files of each kind
CATSEYE_SEED         repeats a campaign
"""

import os
import random
from typing import Final

SEED: Final = int(os.environ.get("CATSEYE_SEED", "20261128"))
BYTES: Final = int(os.environ.get("CATSEYE_FUZZ_BYTES", "200000"))
FILES: Final = int(os.environ.get("CATSEYE_FUZZ_FILES", "25"))


def source(*what: object) -> random.Random:
    """Return numbers at random, others for each thing that is tried, and the same ones for the same seed."""
    return random.Random(f"{SEED} {what}")


def tell(text: str) -> None:
    """Print a figure of a campaign with the seed that repeats it."""
    print(f"\n{text} (CATSEYE_SEED={SEED})", flush=True)  # noqa: T201  # the figure
