"""`catseye emulate` for clients of the controller that need more axes or a terminator."""

import socket
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from app.cell.load import load_cell
from tests.system.command import catseye, emulated


def test_the_controller_tells_the_axes_and_ends_as_a_client_needs_it(tmp_path: Path) -> None:
    with emulated(tmp_path, "--axes", "8", "--suffix", "crlf") as bench:
        at = urlsplit(load_cell(bench.cell).cell.robot.endpoint)
        with socket.create_connection((str(at.hostname), int(at.port or 0)), timeout=5) as robot:
            robot.sendall(b"1;1;OPEN=USERTOOL")
            assert robot.recv(512).startswith(b"QoKFF;FF;")
            robot.sendall(b"1;1;JPOSF")
            answer = robot.recv(512)
    assert answer.startswith(b"QoKJ1;0.00;J2;")
    assert answer.endswith(b"J8;0.00;;****,****;100;0.00;00000000\r\n")


@pytest.mark.parametrize(
    ("option", "value", "said"), [("--axes", "5", "4, 6 or 8 axes"), ("--suffix", "lf", "none, cr, crlf")]
)
def test_other_choices_are_refused(tmp_path: Path, option: str, value: str, said: str) -> None:
    catseye("init", "cell.toml", cwd=tmp_path)
    done = catseye("emulate", "cell.toml", option, value, cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
