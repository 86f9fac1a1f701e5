"""What starting the command line costs, and that each command finds what it needs."""

import pkgutil
import subprocess
import sys

from catseye.app import cli
from tests.system.command import environment

HEAVY = ("numpy", "scipy", "matplotlib", "textual", "pydantic", "pymodbus")


def test_help_imports_nothing_heavy() -> None:
    code = f"import sys, catseye.app.cli; print([name for name in {HEAVY!r} if name in sys.modules])"
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


EACH_ALONE = """
import importlib, os, sys, traceback
import matplotlib.figure, numpy, scipy.interpolate, scipy.optimize, scipy.stats, textual.app, textual.widgets
from pydantic import BaseModel, TypeAdapter
import catseye.app.cli

for name in sys.argv[1:]:
    child = os.fork()
    if child:
        if os.waitpid(child, 0)[1]:
            print(name)
    else:
        try:
            importlib.import_module(name)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        os._exit(0)
"""
"""Libraries are imported before: they take longest, and are not what may be missing."""


def test_each_command_is_imported_where_no_other_one_was() -> None:
    """Commands of most system tests are forked off a process that has imported all of them."""
    names = [module.name for module in pkgutil.walk_packages(cli.__path__, f"{cli.__name__}.")]
    assert len(names) > 20
    command = [sys.executable, "-c", EACH_ALONE, *names]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=True)
    assert not done.stdout, done.stderr
