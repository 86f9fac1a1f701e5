"""Call the command of modbus-cli: `modbus_command.py PORT LINE`; prints what it read.

LINE is that of a sensor with Comet's map, 9600 8N2 and address 1.
"""

import json
import subprocess
import sys
from pathlib import Path

COMMAND = Path(sys.executable).parent / "modbus"


def read(*arguments: str) -> list[float]:
    """Return the values that the command prints."""
    done = subprocess.run(
        [COMMAND, "--silent", *arguments], capture_output=True, text=True, timeout=30, check=True
    )
    # What it says of its files of names comes before them.
    values = [line.split()[-1] for line in done.stdout.splitlines() if line[:1].isdigit()]
    return [float(value) for value in values]


floats = read("--byte-order=mixed", f"127.0.0.1:{sys.argv[1]}", "h@0/f", "h@2/f")
comet = read("-b", "9600", "-p", "2", "-P", "n", "-s", "1", sys.argv[2], "h@48/h")
print("\n" + json.dumps({"floats": floats, "comet_c": comet[0] / 10}))  # noqa: T201  # data for the test
