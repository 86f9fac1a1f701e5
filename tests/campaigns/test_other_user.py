"""Another user of the computer reaches neither the socket of an engine nor its folder; takes root, to become one."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from catseye.app.service.address import find_socket, listening
from tests.system.command import own_runtime
from tests.unit.app.guard.other_user import NOBODY

BECOME = f"""
import os, socket, sys
os.setgroups([])
os.setegid({NOBODY})
os.seteuid({NOBODY})
"""
CONNECT = """
import socket, sys
try:
    socket.socket(socket.AF_UNIX).connect(sys.argv[1])
except PermissionError:
    print("refused")
"""
LIST = """
try:
    os.listdir(os.path.dirname(sys.argv[1]))
except PermissionError:
    print("refused")
"""


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can become another user")
@pytest.mark.parametrize("program", [CONNECT, LIST], ids=["connect", "list"])
def test_another_user_is_refused_by_the_system(tmp_path: Path, program: str) -> None:
    with own_runtime(), listening(tmp_path):
        path = find_socket(tmp_path)
        assert path is not None
        words = [sys.executable, "-I", "-c", BECOME + program, str(path)]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert done.stdout == "refused\n"


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can become another user")
def test_the_same_program_connects_as_its_owner(tmp_path: Path) -> None:
    with own_runtime(), listening(tmp_path):
        words = [sys.executable, "-I", "-c", CONNECT, str(find_socket(tmp_path))]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert done.stdout == ""
