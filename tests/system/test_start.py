"""What starting the command line costs."""

import subprocess
import sys

from tests.system.command import environment

HEAVY = ("numpy", "scipy", "matplotlib", "textual", "pydantic", "pymodbus")


def test_help_imports_nothing_heavy() -> None:
    code = f"import sys, app.cli; print([name for name in {HEAVY!r} if name in sys.modules])"
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
