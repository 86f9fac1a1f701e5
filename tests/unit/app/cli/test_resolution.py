"""`catseye resolution` on recordings made from geometry: S · sin θ of a joint whose steps are known."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.results.resolution.result import ResolutionResult, read_resolution
from tests.unit.app.results.resolution.recordings import (
    DWELL_S,
    STILL_S,
    Files,
    decaying_commands,
    write_test,
)

_A1 = ("--joint", "A1", "--position-deg", "-90", "--arm", "kr210-r2700", "--spacing-mm", "30")


def said(*words: object) -> tuple[int, str, str]:
    """Return exit code, stdout and stderr of a command line."""
    done = CliRunner().invoke(cli, ["resolution", *map(str, words)])
    return done.exit_code, done.stdout, done.stderr


def _run(tmp_path: Path, files: Files, *more: object) -> ResolutionResult:
    output = tmp_path / "result.json"
    given = ("--recording", files.recording, "--moves", files.moves, "-o", output)
    code, _, talk = said(*given, *_A1, *more)
    assert code == 0, talk
    return read_resolution(output)


@pytest.fixture
def decaying(tmp_path: Path) -> Files:
    """Steps down to 0.001°, each 2 % too large."""
    command = decaying_commands(66)
    return write_test(tmp_path, command.tolist(), (1.02 * command).tolist())


def test_steps_are_measured_as_they_were_made(tmp_path: Path, decaying: Files) -> None:
    result = _run(tmp_path, decaying, "--test", "decaying")
    (test,) = result.tests
    assert (result.arm, test.joint, test.position, test.direction) == ("KR 210 R2700", "A1", -90.0, 1)
    errors = [move.error_percent for move in test.moves]
    assert len(errors) == 66
    assert errors == pytest.approx([2.0] * 66, abs=0.2)
    assert test.staircase is not None
    assert len(test.staircase.plateau) == 67


def test_a_test_downwards_states_its_direction(tmp_path: Path) -> None:
    command = decaying_commands(20, -1)
    files = write_test(tmp_path, command.tolist(), command.tolist())
    assert _run(tmp_path, files, "--test", "decaying").tests[0].direction == -1


def test_the_actuation_comes_from_the_arm(tmp_path: Path, decaying: Files) -> None:
    result = _run(tmp_path, decaying, "--test", "decaying")
    assert [round(1e6 * one.ideal_lis_deg, 1) for one in result.actuation] == [5.3, 5.4, 5.8, 6.9, 6.5, 10.5]


def _backlash(tmp_path: Path) -> Files:
    command = [0.1] * 10 + [-0.1] * 10
    return write_test(tmp_path, command, command)


def _trace(tmp_path: Path, names: tuple[str, ...]) -> Path:
    """Write a trace whose torque is 20 N m while the joint goes forwards and −10 N m on the way back."""
    rows = int((STILL_S + 21 * DWELL_S) / 0.012)
    turn_s = STILL_S + 10 * DWELL_S
    header = [
        "DIAEXTENDED",
        "#BEGINGLOBALHEADER",
        "101,x",
        "#ENDGLOBALHEADER",
        "#BEGINCHANNELHEADER",
        "200,Zeit",
    ]
    header += ["202,s", "210,IMPLIZIT", f"220,{rows}", "240,0", "241,0.012", "#ENDCHANNELHEADER"]
    for column, name in enumerate(names, 1):
        header += ["#BEGINCHANNELHEADER", f"200,{name}", "202,Nm", "210,EXPLIZIT", "211,t.r64", "213,BLOCK"]
        header += ["214,REAL64", f"220,{rows}", f"221,{column}", "#ENDCHANNELHEADER"]
    (tmp_path / "t.dat").write_text("\n".join(header), "latin-1")
    values = [20.0 if 0.012 * row < turn_s else -10.0 for row in range(rows) for _ in names]
    (tmp_path / "t.r64").write_bytes(struct.pack(f"<{len(values)}d", *values))
    return tmp_path / "t.dat"


def test_the_torque_of_a_trace_stands_by_direction(tmp_path: Path) -> None:
    trace = _trace(tmp_path, ("Torque_A1", "Torque_A2"))
    more = ("--test", "backlash", "--joint-torque", trace, "--torque-channel", "Torque_A1")
    torque = _run(tmp_path, _backlash(tmp_path), *more).tests[0].torque
    assert torque is not None
    assert (torque.forward_nm, torque.backward_nm) == (20.0, -10.0)


def test_a_torque_of_another_run_is_refused(tmp_path: Path) -> None:
    files, torque = _backlash(tmp_path), tmp_path / "torque.csv"
    torque.write_text("t_s,torque_nm\n0,1\n10,2\n", "utf-8")
    given = ("--recording", files.recording, "--moves", files.moves, "-o", tmp_path / "r.json", *_A1)
    code, _, talk = said(*given, "--test", "backlash", "--joint-torque", torque)
    assert code == 2
    assert "no value on the plateau behind move 1" in talk


def test_target_deviations_give_a_reversal_error(tmp_path: Path) -> None:
    lines = ["Target-count: 3", "Targets :", "0 1 2", "Run-count: 4", "Run Target Data:"]
    lines += [f"{run} {target} {5.0 * (run % 2 == 0)}" for run in range(1, 5) for target in range(1, 4)]
    path, output = tmp_path / "a1.rta", tmp_path / "r.json"
    path.write_text("\n".join(lines), "utf-8")
    more = ("--test", "backlash", "--deviation-unit", "arcsec", "-o", output)
    code, _, talk = said("--recording", path, *_A1, *more)
    assert code == 0, talk
    reversal = read_resolution(output).tests[0].reversal
    assert reversal is not None
    assert (reversal.value, reversal.valid) == (pytest.approx(5.0 / 3600.0), None)


def test_a_preview_writes_a_mapping_that_reads_the_file(tmp_path: Path, decaying: Files) -> None:
    foreign = tmp_path / "laser.txt"
    rows = np.loadtxt(decaying.recording, delimiter=",", skiprows=1)
    text = "\n".join(f"{1e3 * t:.3f};{1e3 * x:.9f}".replace(".", ",") for t, x in rows)
    foreign.write_text(f"Laser 7\nZeit (ms);Weg (µm)\n{text}\n", "cp1252")
    code, mapping, talk = said("--recording", foreign, "--preview")
    assert code == 0, talk
    assert "50.0000 Hz" in talk
    (tmp_path / "laser.toml").write_text(mapping, "utf-8")
    again = _run(
        tmp_path, Files(foreign, decaying.moves), "--test", "decaying", "--mapping", tmp_path / "laser.toml"
    )
    plain = _run(tmp_path, decaying, "--test", "decaying")
    measured, expected = ([move.measured for move in one.tests[0].moves] for one in (again, plain))
    assert measured == pytest.approx(expected, abs=1e-8)


def test_json_states_the_result_without_the_recording(tmp_path: Path, decaying: Files) -> None:
    given = ("--recording", decaying.recording, "--moves", decaying.moves, "-o", tmp_path / "r.json")
    code, out, _ = said(*given, *_A1, "--test", "decaying", "--json")
    document: dict[str, Any] = json.loads(out)
    assert code == 0
    assert document["tests"][0]["test"] == "decaying"
    assert "staircase" not in document["tests"][0]


@pytest.mark.parametrize(
    ("changed", "complaint"),
    [
        (("--joint", "J7"), "--joint J7: a decaying test of KR 210 R2700 is of A1, A2"),
        (("--arm", "kr999"), "--arm kr999: there is no description of an arm kr999"),
        (("--spacing-mm", "300"), "the 10 largest moves show 0.1 of what was commanded|show 0.102"),
        (("--test", "cartesian"), "--joint A1: a cartesian test of KR 210 R2700 is of X, Y, Z"),
    ],
)
def test_what_does_not_belong_together_is_refused(
    tmp_path: Path, decaying: Files, changed: tuple[str, str], complaint: str
) -> None:
    words = dict(zip(_A1[::2], _A1[1::2], strict=True)) | {"--test": "decaying"} | dict([changed])
    given = ("--recording", decaying.recording, "--moves", decaying.moves, "-o", tmp_path / "r.json")
    code, _, talk = said(*given, *(part for pair in words.items() for part in pair))
    assert code in {1, 2}
    assert any(text in talk for text in complaint.split("|"))
    assert not (tmp_path / "r.json").exists()


def test_moves_of_another_run_are_refused(tmp_path: Path, decaying: Files) -> None:
    lines = decaying.moves.read_text("utf-8").splitlines()
    later = [f"{float(t) + 400.0},{x}" for t, x in (line.split(",") for line in lines[1:])]
    decaying.moves.write_text("\n".join([lines[0], *later]) + "\n", "utf-8")
    given = ("--recording", decaying.recording, "--moves", decaying.moves, "-o", tmp_path / "r.json", *_A1)
    code, _, talk = said(*given, "--test", "decaying")
    assert code == 1
    assert "the recording is cut off, these are moves of another run, or the clocks differ" in talk


@pytest.mark.parametrize("missing", ["--recording", "--moves", "--test", "--joint", "--arm", "-o"])
def test_a_missing_option_is_named(tmp_path: Path, decaying: Files, missing: str) -> None:
    words = {
        "--recording": str(decaying.recording),
        "--moves": str(decaying.moves),
        "--test": "decaying",
        "--joint": "A1",
        "--arm": "kr210-r2700",
        "-o": str(tmp_path / "r.json"),
    }
    del words[missing]
    code, _, talk = said(*(part for pair in words.items() for part in pair))
    assert code == 2
    assert f"{missing} is missing" in talk
