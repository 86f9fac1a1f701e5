"""Another user who wants an arm. Arguments: the folder of the locks, and the arm."""

import os
import sys
from pathlib import Path
from unittest.mock import patch

from catseye.app.errors import ArmInUseError
from catseye.app.guard import lock
from catseye.app.guard.lock import Owner, OwnerLock

NOBODY = 65_534


def main(arm: str) -> None:
    """Take the arm and give it back; say who has it where somebody has."""
    if os.geteuid() == 0:
        os.seteuid(NOBODY)
    try:
        taken = OwnerLock((arm,), Owner("14", "nobody", "catseye run", "a run", "now"))
    except ArmInUseError as error:
        print(error)  # noqa: T201  # what the test reads
    else:
        print(f"owns {taken.arm}")  # noqa: T201  # what the test reads
        taken.release()


if __name__ == "__main__":
    with patch.object(lock, "_FOLDERS", (Path(sys.argv[1]),)):
        main(sys.argv[2])
