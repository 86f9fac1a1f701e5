"""What starting the command line costs, and that each command finds what it needs."""

import subprocess
import sys

from catseye.app import cli
from tests.system.command import environment
from tests.system.command_imports import imported_by, modules_below

HEAVY = ("numpy", "scipy", "matplotlib", "textual", "pydantic", "pymodbus")


def test_help_lists_every_command_and_imports_nothing_heavy() -> None:
    code = f"""
import sys
from typer.testing import CliRunner
from catseye.app.cli import cli
from catseye.app.cli.commands import COMMANDS
help_text = CliRunner().invoke(cli, ["--help"]).output
print([name for name in COMMANDS if f"  {{name}} " not in help_text])
print([name for name in {HEAVY!r} if name in sys.modules])
print([name for name in COMMANDS if f"{{COMMANDS[name].package}}.{{name}}" in sys.modules])
"""
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["[]", "[]", "[]"]


EACH_ALONE = """
import importlib, os, sys, traceback
import matplotlib.figure, numpy, scipy.interpolate, scipy.optimize, scipy.stats, textual.app, textual.widgets
from pydantic import BaseModel, TypeAdapter
import catseye.app.cli

for names in map(str.split, sys.argv[1:]):
    child = os.fork()
    if child:
        if os.waitpid(child, 0)[1]:
            print(names[0])
    else:
        try:
            for name in names:
                importlib.import_module(name)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        os._exit(0)
"""
"""Libraries are imported before: they take longest, and are not what may be missing."""


def test_each_command_is_imported_where_no_other_one_was() -> None:
    """Commands of most system tests are forked off a process that has imported all of them."""
    names = modules_below(cli)
    assert len(names) > 20
    command = [sys.executable, "-c", EACH_ALONE, *(" ".join([name, *imported_by(name)]) for name in names)]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=True)
    assert not done.stdout, done.stderr
