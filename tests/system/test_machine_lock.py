"""A MELFA whose machine somebody locks: nothing is measured, since it reports motions that the arm does not make."""

import json
import re
import socket
import time
from pathlib import Path

from tests.patience import HANG_S
from tests.system.command import Emulated, begun, emulated, own_runtime


def lock(bench: Emulated) -> None:
    """Lock the machine from another connection, between two motions: no operation right is needed for it."""
    found = re.search(
        r'"tcp://(127\.0\.0\.1):(\d+)"', bench.cell.read_text(encoding="utf-8").split("[robot]")[1]
    )
    assert found is not None
    give_up_s = time.monotonic() + HANG_S
    with socket.create_connection((found[1], int(found[2])), timeout=HANG_S) as connection:
        while time.monotonic() < give_up_s:
            connection.sendall(b"1;1;MLOCKON\r")
            if connection.recv(100).lower().startswith(b"qok"):
                return
    raise AssertionError("the machine could not be locked")


def test_a_run_ends_when_its_machine_is_locked(tmp_path: Path) -> None:
    options = ["--speed", "400", "--search", "none", "--json", "--param", 'reflectors=["P2"]']
    with own_runtime(), emulated(tmp_path) as bench:
        with begun("run", "open-loop", "--cell", bench.cell, *options, cwd=tmp_path) as (process, output):
            while json.loads(output.readline())["event"] != "step-started":
                pass
            lock(bench)
            said = [json.loads(line) for line in output]
            assert process.wait(HANG_S) == 5, said
        assert said[-1]["status"] == "aborted", said
        assert "machine lock is on" in said[-1]["text"], said
