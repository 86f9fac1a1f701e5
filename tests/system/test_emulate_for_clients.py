"""`catseye emulate` for clients of the controller that need more axes or a terminator."""

import socket
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from catseye.app.cell.load import load_cell
from tests.patience import HANG_S
from tests.system.command import catseye, emulated


def test_the_controller_answers_with_chosen_axes_and_suffix(tmp_path: Path) -> None:
    with emulated(tmp_path, "--axes", "8", "--suffix", "crlf") as bench:
        at = urlsplit(load_cell(bench.cell).cell.robot.endpoint)
        with socket.create_connection((str(at.hostname), int(at.port or 0)), timeout=HANG_S) as robot:
            robot.sendall(b"1;1;OPEN=USERTOOL")
            assert robot.recv(512).startswith(b"QoKFF;FF;")
            robot.sendall(b"1;1;JPOSF")
            answer = robot.recv(512)
    assert answer.startswith(b"QoKJ1;0.00;J2;")
    assert answer.endswith(b"J8;0.00;;****,****;100;0.00;00000000\r\n")


def test_the_unaligned_bench_has_an_offset_and_reversed_screws(tmp_path: Path) -> None:
    with emulated(tmp_path, "--unaligned", "--screw-sense", "reversed", "--seed", "4") as bench:
        before = bench.ask(op="state")["mount"]
        bench.ask(op="turn_screw", screw="stage", turns=1.0)
        after = bench.ask(op="state")["mount"]
    assert 0.4 <= abs(before["offset_mm"]) <= 0.9
    assert 0.6 <= abs(before["pitch_mrad"]) <= 1.5
    # Clockwise is +y, 0.5 mm a turn, in the cell file; a hand sets it to some hundredths of a turn.
    assert after["offset_mm"] - before["offset_mm"] == pytest.approx(-0.5, abs=0.05)


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--axes", "5", "4, 6 or 8 axes"),
        ("--suffix", "lf", "none, cr, crlf"),
        ("--screw-sense", "left", "normal or reversed"),
    ],
)
def test_other_choices_are_refused(tmp_path: Path, option: str, value: str, said: str) -> None:
    catseye("init", "cell.toml", cwd=tmp_path)
    done = catseye("emulate", "cell.toml", option, value, cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
