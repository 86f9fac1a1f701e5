"""Where runs are kept."""

import os
from pathlib import Path

VARIABLE = "CATSEYE_RUNS"


def runs_folder(given: Path | None) -> Path:
    """Return the folder of all runs: as given, from the environment, or ./catseye-runs."""
    if given is not None:
        return given
    return Path(os.environ.get(VARIABLE, "catseye-runs"))
