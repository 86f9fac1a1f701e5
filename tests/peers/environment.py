"""The environments of the clients: programs in them print data as their last line."""

import asyncio
import json
import os
import subprocess
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PYTHON = ROOT / ".venv-peers" / "bin" / "python"
NODE_MODULES = ROOT / ".venv-peers" / "node_modules"
PATIENCE_S = 120.0


def said_by(script: str, *arguments: str) -> Any:
    """Run a Python script of `clients`, return the last line that it prints, as data."""
    return _data([str(PYTHON), str(HERE / "clients" / script), *arguments])


async def output_of(script: str, *arguments: str) -> Any:
    """Do the same while an event loop goes on."""
    return await asyncio.to_thread(said_by, script, *arguments)


def said_by_node(script: str, *arguments: str) -> Any:
    """Run a JavaScript file of `clients`."""
    return _data(["node", str(HERE / "clients" / script), *arguments])


def _data(command: list[str]) -> Any:
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
        env={**os.environ, "NODE_PATH": str(NODE_MODULES)},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout.splitlines()[-1])
