"""`catseye resolution` on recordings made from geometry: S · sin θ of a joint whose steps are known."""

import json
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.errors import UsageError
from catseye.app.results.resolution.naming import named_positions
from catseye.app.results.resolution.result import ResolutionResult, read_resolution
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import MovesError
from tests.unit.app.results.resolution.recordings import (
    DWELL_S,
    STILL_S,
    Files,
    decaying_commands,
    write_test,
)

_A1 = ("--joint", "A1", "--position-deg", "-90", "--arm", "kr210-r2700", "--spacing-mm", "30")


def said(*words: object) -> tuple[str, str]:
    """Return stdout and stderr of a command line that succeeds."""
    done = CliRunner().invoke(cli, ["resolution", *map(str, words)])
    if done.exception is not None:
        raise done.exception
    return done.stdout, done.stderr


def _run(tmp_path: Path, files: Files, *more: object) -> ResolutionResult:
    output = tmp_path / "result.json"
    given = ("--recording", files.recording, "--moves", files.moves, "-o", output)
    said(*given, *_A1, *more)
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


@pytest.mark.parametrize(("position", "name"), [("0", "K3 = 0°"), ("-90", "K2 = −90°")])
def test_a_position_has_the_name_of_the_arms_place(
    tmp_path: Path, decaying: Files, position: str, name: str
) -> None:
    """A1 is tested at −175, −90, 0, 90 and 175° (the paper, Table 2)."""
    tests = _run(tmp_path, decaying, "--test", "decaying", "--position-deg", position).tests
    assert named_positions(tests, "A1") == [(name, float(position))]


def test_a_test_downwards_states_its_direction(tmp_path: Path) -> None:
    command = decaying_commands(20, -1)
    files = write_test(tmp_path, command.tolist(), command.tolist())
    assert _run(tmp_path, files, "--test", "decaying").tests[0].direction == -1


@pytest.mark.parametrize(
    ("more", "complaint"),
    [
        (("--test", "cartesian", "--joint", "X"), "is in deg, and a cartesian test of X in mm: leave out"),
        (("--test", "decaying", "--position-deg", "999"), "A1 of KR 210 R2700 moves from -185 to 185 deg"),
    ],
)
def test_what_the_arm_does_not_have_is_refused(
    tmp_path: Path, decaying: Files, more: tuple[str, ...], complaint: str
) -> None:
    with pytest.raises(UsageError, match=complaint):
        _run(tmp_path, decaying, *more)
    assert not (tmp_path / "result.json").exists()


def _as_angles(files: Files) -> Files:
    """Rewrite a recording of displacements as one of angles."""
    recording = np.loadtxt(files.recording, delimiter=",", skiprows=1)
    recording[:, 1] = np.degrees(np.arcsin(recording[:, 1] / 30.0))
    np.savetxt(files.recording, recording, delimiter=",", header="t_s,angle_deg", comments="")
    return files


def test_angles_without_an_accuracy_are_flagged(tmp_path: Path, decaying: Files) -> None:
    output = tmp_path / "result.json"
    given = ("--recording", _as_angles(decaying).recording, "--moves", decaying.moves, "-o", output)
    said(*given, *_A1[:-2], "--test", "decaying")
    (silent,) = read_resolution(output).tests
    assert silent.flags[0].startswith("u without the instrument")
    said(*given, *_A1[:-2], "--test", "decaying", "--accuracy-urad", "1", "--accuracy-percent", "0.5")
    (stated,) = read_resolution(output).tests
    assert not [flag for flag in stated.flags if "without the instrument" in flag]
    u, unknown = stated.moves[0].u, silent.moves[0].u
    assert u is not None
    assert unknown is not None
    # 0.5 µrad and 0.25 % of 0.102°, each half of what is stated.
    assert math.sqrt(u**2 - unknown**2) == pytest.approx(math.degrees(0.5e-6) + 0.0025 * 0.102, rel=0.01)


def test_a_spacing_beside_angles_is_no_scale(tmp_path: Path, decaying: Files) -> None:
    test = _run(tmp_path, _as_angles(decaying), "--test", "decaying", "--spacing-mm", "45").tests[0]
    assert [move.error_percent for move in test.moves] == pytest.approx([2.0] * 66, abs=0.2)
    assert any("--spacing-mm does not change them" in text for text in test.doubts)


def test_what_speaks_against_a_test_is_said(tmp_path: Path, decaying: Files) -> None:
    rows = decaying.recording.read_text("utf-8").splitlines()
    # At 50 Hz, nine seconds of standstill are left.
    decaying.recording.write_text("\n".join([rows[0], *rows[2550:]]) + "\n", "utf-8")
    given = ("--recording", decaying.recording, "--moves", decaying.moves, "-o", tmp_path / "result.json")
    _, talk = said(*given, *_A1, "--test", "decaying")
    assert "least step" in talk
    assert "no 10 s of rest before the first move" in " ".join(talk.split())


def test_an_accuracy_of_angles_is_none_of_displacements(tmp_path: Path, decaying: Files) -> None:
    with pytest.raises(UsageError, match="holds displacements, whose accuracy is that of their optics"):
        _run(tmp_path, decaying, "--test", "decaying", "--accuracy-urad", "1")


def test_lengths_of_a_joint_that_turns_are_refused(tmp_path: Path, decaying: Files) -> None:
    decaying.moves.write_text(decaying.moves.read_text("utf-8").replace("_deg", "_mm"), "utf-8")
    recording = np.loadtxt(decaying.recording, delimiter=",", skiprows=1)
    recording[:, 1] = np.degrees(np.arcsin(recording[:, 1] / 30.0))
    np.savetxt(decaying.recording, recording, delimiter=",", header="t_s,displacement_mm", comments="")
    given = ("--recording", decaying.recording, "--moves", decaying.moves, "-o", tmp_path / "result.json")
    with pytest.raises(UsageError, match="state the spacing of the angular optics by --spacing-mm"):
        said(*given, *_A1[:-2], "--test", "decaying")


def test_the_actuation_comes_from_the_arm(tmp_path: Path, decaying: Files) -> None:
    result = _run(tmp_path, decaying, "--test", "decaying")
    assert [round(1e6 * one.ideal_lis_deg, 1) for one in result.actuation] == [5.3, 5.4, 5.8, 6.9, 6.5, 10.5]


def test_the_least_step_is_where_the_errors_begin(tmp_path: Path) -> None:
    """From the 61st step on the joint makes 0.4 of each, so the mean over 11 steps leaves 10 % behind the 56th."""
    command = decaying_commands(80)
    moved = np.where(np.arange(80) < 60, command, 0.4 * command)
    test = _run(tmp_path, write_test(tmp_path, command.tolist(), moved.tolist()), "--test", "decaying").tests[
        0
    ]
    assert test.lis is not None
    assert test.lis.low <= command[55] <= test.lis.high
    assert test.lis.high < command[50]
    assert test.by_rule == pytest.approx(command[55])


def test_a_glitch_leaves_the_least_step_as_it_is(tmp_path: Path, decaying: Files) -> None:
    plain = _run(tmp_path, decaying, "--test", "decaying").tests[0]
    lines = decaying.recording.read_text("utf-8").splitlines()
    time_s, displacement_mm = lines[8001].split(",")
    lines[8001] = f"{time_s},{float(displacement_mm) + 5.0:.12g}"
    decaying.recording.write_text("\n".join(lines) + "\n", "utf-8")
    test = _run(tmp_path, decaying, "--test", "decaying").tests[0]
    assert test.lis is not None
    assert plain.lis is not None
    assert test.lis.value == pytest.approx(plain.lis.value)
    assert any(" samples lie far off" in text for text in test.doubts)


def test_a_wrong_spacing_stands_in_the_result(tmp_path: Path) -> None:
    command = decaying_commands(40)
    files = write_test(tmp_path, command.tolist(), (1.01 * command).tolist())
    test = _run(tmp_path, files, "--test", "decaying", "--spacing-mm", "60").tests[0]
    assert test.lis is None
    assert test.likely_mistake is not None
    assert test.likely_mistake.factor == 0.5
    assert test.likely_mistake.text.startswith("the stated spacing is twice the real one")


def test_a_joint_that_goes_short_names_that_as_the_reason(tmp_path: Path) -> None:
    """Of optics whose zero nobody states a flag says that it is assumed, which is no reason for anything."""
    command = decaying_commands(40)
    files = write_test(tmp_path, command.tolist(), (0.8 * command).tolist())
    output = tmp_path / "result.json"
    given = ("--recording", files.recording, "--moves", files.moves, "-o", output)
    _, talk = said(*given, *_A1, "--test", "decaying")
    (test,) = read_resolution(output).tests
    assert any("are taken as parallel" in flag for flag in test.flags)
    expected = "no least step can be stated: the mean error of the largest steps, 0.1° and less, is -20 %"
    assert expected in " ".join(talk.split())
    assert test.lis_reason is not None
    assert test.lis_reason in test.flags


@pytest.mark.parametrize(
    ("suffix", "instruction"),
    [
        (".rtx", "export the samples from the program that recorded them"),
        (".rta", "it is not a recording; --test backlash accepts it"),
    ],
)
def test_a_file_that_is_no_recording_says_what_to_do(tmp_path: Path, suffix: str, instruction: str) -> None:
    """Whoever has such a file has no moves beside it yet."""
    file = tmp_path / f"a{suffix}"
    file.write_text("HEADER::\n", "utf-8")
    with pytest.raises(UsageError, match=instruction):
        said("--recording", file, *_A1, "--test", "decaying", "-o", tmp_path / "result.json")


def test_two_clocks_are_aligned_and_reported(tmp_path: Path) -> None:
    command = decaying_commands(40)
    files = write_test(tmp_path, command.tolist(), command.tolist(), ahead_s=1234.5)
    test = _run(tmp_path, files, "--test", "decaying", "--align", "auto").tests[0]
    assert test.clocks is not None
    assert test.clocks.offset_s == pytest.approx(1234.5, abs=0.1)
    assert abs(test.clocks.offset_s - 1234.5) < 2.0 * test.clocks.u_offset_s < 0.3
    assert test.clocks.about_s == pytest.approx(STILL_S + 0.5 * 39 * DWELL_S)
    assert test.flags[0].startswith("the recording's clock is 1234.")
    assert "at 158 s of theirs, the delay between command and motion included" in test.flags[0]
    assert not any("no 10 s of rest" in text for text in test.flags)
    assert [move.error_percent for move in test.moves] == pytest.approx([0.0] * 40, abs=0.2)


def test_a_clock_that_is_behind_is_said_so(tmp_path: Path) -> None:
    command = decaying_commands(40)
    files = write_test(tmp_path, command.tolist(), command.tolist(), ahead_s=-5.5)
    test = _run(tmp_path, files, "--test", "decaying", "--align", "auto").tests[0]
    assert test.flags[0].startswith("the recording's clock is 5.")
    assert "behind that of the moves" in test.flags[0]


def test_iso_steps_that_play_swallows_do_not_pass(tmp_path: Path) -> None:
    """Play of 0.003° swallows steps of 0.001° after each reversal, and leaves something of those of 0.01°."""
    signs = np.repeat([1.0, -1.0, 1.0], 10)
    command = np.concatenate([0.001 * signs, 0.01 * signs])
    files = write_test(tmp_path, command.tolist(), _with_play(command, 0.003).tolist())
    test = _run(tmp_path, files, "--test", "iso").tests[0]
    assert test.amplitudes is not None
    assert [one.distinguishable for one in test.amplitudes] == [False, True]
    assert test.lis is not None
    assert [test.lis.low, test.lis.value] == pytest.approx([0.001, 0.01])
    assert not any("behind the last move" in text for text in test.flags)


def test_a_wrong_spacing_of_a_backlash_test_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MovesError, match=r"are 0\.667 times those commanded.*the real one is 0\.667 times"):
        _run(tmp_path, _backlash(tmp_path), "--test", "backlash", "--spacing-mm", "45")


def _with_play(command: Floats, play_deg: float) -> Floats:
    """Return what a joint does that follows one flank or the other of its play."""
    motor, link, moved = 0.0, 0.0, []
    for step in command.tolist():
        motor += step
        new = min(max(link, motor - play_deg), motor)
        moved.append(new - link)
        link = new
    return np.array(moved)


def _backlash(tmp_path: Path) -> Files:
    """Return 5 × (10 + 10) steps of 0.1° of a joint with play of 0.006°, which it has taken up at the beginning."""
    command = np.tile(np.repeat([0.1, -0.1], 10), 5)
    moved = _with_play(np.concatenate([[0.1], command]), 0.006)[1:]
    return write_test(tmp_path, command.tolist(), moved.tolist())


def _trace(tmp_path: Path, names: tuple[str, ...]) -> Path:
    """Write a trace whose torque is some 20 N m while the joint goes forwards and −10 N m on the way back."""
    rows = int((STILL_S + 101 * DWELL_S) / 0.012)
    noise = np.random.default_rng(5).normal(0.0, 0.5, rows)
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
    back = (0.012 * np.arange(rows) - STILL_S) // (10 * DWELL_S) % 2 == 1
    values = np.repeat(np.where(back, -10.0, 20.0) + noise, len(names)).tolist()
    (tmp_path / "t.r64").write_bytes(struct.pack(f"<{len(values)}d", *values))
    return tmp_path / "t.dat"


def test_the_torque_of_a_trace_stands_by_direction(tmp_path: Path) -> None:
    trace = _trace(tmp_path, ("Torque_A1", "Torque_A2"))
    more = ("--test", "backlash", "--joint-torque", trace, "--torque-channel", "Torque_A1")
    torque = _run(tmp_path, _backlash(tmp_path), *more).tests[0].torque
    assert torque is not None
    assert [torque.forward_nm, torque.backward_nm] == pytest.approx([20.0, -10.0], abs=0.1)


def test_lost_motion_is_found_between_the_ends(tmp_path: Path) -> None:
    trace = _trace(tmp_path, ("Torque_A1",))
    more = ("--test", "backlash", "--joint-torque", trace)
    test = _run(tmp_path, _backlash(tmp_path), *more).tests[0]
    assert test.reversal is not None
    assert test.reversal.value == pytest.approx(0.006, abs=1e-5)
    assert test.reversal.valid is True
    assert test.targets is not None
    assert len(test.targets) == 9


def test_a_torque_of_another_run_is_refused(tmp_path: Path) -> None:
    files, torque = _backlash(tmp_path), tmp_path / "torque.csv"
    torque.write_text("t_s,torque_nm\n0,1\n10,2\n", "utf-8")
    given = ("--recording", files.recording, "--moves", files.moves, "-o", tmp_path / "r.json", *_A1)
    with pytest.raises(MovesError, match="the torque is cut off, of another run, or by another clock"):
        said(*given, "--test", "backlash", "--joint-torque", torque)


def test_target_deviations_give_a_reversal_error(tmp_path: Path) -> None:
    lines = ["Target-count: 3", "Targets :", "0 1 2", "Run-count: 4", "Run Target Data:"]
    lines += [f"{run} {target} {5.0 * (run % 2)}" for run in range(1, 5) for target in range(1, 4)]
    path, output = tmp_path / "a1.rta", tmp_path / "r.json"
    path.write_text("\n".join(lines), "utf-8")
    more = ("--test", "backlash", "--deviation-unit", "arcsec", "-o", output)
    said("--recording", path, *_A1, *more)
    reversal = read_resolution(output).tests[0].reversal
    assert reversal is not None
    assert reversal.value == pytest.approx(-5.0 / 3600.0)
    assert reversal.valid is None
    assert read_resolution(output).tests[0].doubts == [
        "--spacing-mm: without effect on deviations at targets"
    ]


def test_a_preview_writes_a_mapping_that_reads_the_file(tmp_path: Path, decaying: Files) -> None:
    foreign = tmp_path / "laser.txt"
    rows = np.loadtxt(decaying.recording, delimiter=",", skiprows=1)
    text = "\n".join(f"{1e3 * t:.3f};{1e3 * x:.9f}".replace(".", ",") for t, x in rows)
    foreign.write_text(f"Laser 7\nZeit (ms);Weg (µm)\n{text}\n", "cp1252")
    mapping, talk = said("--recording", foreign, "--preview")
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
    out, _ = said(*given, *_A1, "--test", "decaying", "--json")
    document: dict[str, Any] = json.loads(out)
    assert document["tests"][0]["test"] == "decaying"
    assert "staircase" not in document["tests"][0]


@pytest.mark.parametrize(
    ("changed", "complaint"),
    [
        (("--joint", "J7"), "--joint J7: a decaying test of KR 210 R2700 is of A1, A2"),
        (("--arm", "kr999"), "--arm kr999: there is no description of an arm kr999"),
        (("--spacing-mm", "300"), "the 10 largest moves show 0.102 of what was commanded"),
        (("--test", "cartesian"), "--joint A1: a cartesian test of KR 210 R2700 is of X, Y, Z"),
    ],
)
def test_what_does_not_belong_together_is_refused(
    tmp_path: Path, decaying: Files, changed: tuple[str, str], complaint: str
) -> None:
    words = dict(zip(_A1[::2], _A1[1::2], strict=True)) | {"--test": "decaying"} | dict([changed])
    given = ("--recording", decaying.recording, "--moves", decaying.moves, "-o", tmp_path / "r.json")
    with pytest.raises((UsageError, MovesError), match=complaint):
        said(*given, *(part for pair in words.items() for part in pair))
    assert not (tmp_path / "r.json").exists()


def test_moves_of_another_run_are_refused(tmp_path: Path, decaying: Files) -> None:
    lines = decaying.moves.read_text("utf-8").splitlines()
    later = [f"{float(t) + 400.0},{x}" for t, x in (line.split(",") for line in lines[1:])]
    decaying.moves.write_text("\n".join([lines[0], *later]) + "\n", "utf-8")
    given = ("--recording", decaying.recording, "--moves", decaying.moves, "-o", tmp_path / "r.json", *_A1)
    with pytest.raises(
        MovesError, match=r"is cut off, .* these are moves of another run, or the clocks differ"
    ):
        said(*given, "--test", "decaying")


def test_decreasing_steps_are_no_iso_test(tmp_path: Path, decaying: Files) -> None:
    with pytest.raises(
        MovesError, match=r"moves.csv:2: move 1 is the only one of its size: a test by ISO 230 has three"
    ):
        _run(tmp_path, decaying, "--test", "iso")


def test_moves_that_do_not_fit_name_their_line(tmp_path: Path, decaying: Files) -> None:
    lines = decaying.recording.read_text("utf-8").splitlines()
    decaying.recording.write_text("\n".join(lines[:6000]) + "\n", "utf-8")
    given = ("--recording", decaying.recording, "--moves", decaying.moves, "-o", tmp_path / "r.json", *_A1)
    # 5999 samples at 50 Hz end at 119.96 s; the move at 115 s is the twelfth, in line 13.
    with pytest.raises(MovesError, match=r"moves.csv:14: .* but move 13 of \d+, commanded at 120 s"):
        said(*given, "--test", "decaying")


def test_a_saturated_recording_names_its_line(tmp_path: Path, decaying: Files) -> None:
    t_s, displacement_mm = np.loadtxt(decaying.recording, delimiter=",", skiprows=1).T
    # At 50 Hz, the sample at 200 s is the 10001st, in line 10002.
    displacement_mm[10_000:] = displacement_mm[:10_000].max()
    rows = (f"{t:.6f},{x:.12g}" for t, x in zip(t_s, displacement_mm, strict=True))
    decaying.recording.write_text("\n".join(["t_s,displacement_mm", *rows]) + "\n", "utf-8")
    with pytest.raises(UsageError, match=r"recording.csv:10002: from 200.00 s .*saturated.*measure again"):
        _run(tmp_path, decaying, "--test", "decaying")


def test_a_coarse_recording_at_rest_is_evaluated(tmp_path: Path, decaying: Files) -> None:
    t_s, displacement_mm = np.loadtxt(decaying.recording, delimiter=",", skiprows=1).T
    rows = (f"{t:.6f},{x:.5f}" for t, x in zip(t_s, displacement_mm, strict=True))
    decaying.recording.write_text("\n".join(["t_s,displacement_mm", *rows]) + "\n", "utf-8")
    test = _run(tmp_path, decaying, "--test", "decaying").tests[0]
    assert [move.error_percent for move in test.moves] == pytest.approx([2.0] * 66, abs=3.0)
    assert not any("last digit" in text for text in test.flags)


def test_a_recording_with_gaps_is_evaluated_with_flags(tmp_path: Path) -> None:
    command = decaying_commands(40).tolist()
    files = write_test(tmp_path, command, command)
    lines = files.recording.read_text("utf-8").splitlines()
    # The twenty-first move begins at 160 s; samples are missing from 156 s to 160.5 s, and a few before 120 s.
    kept = [line for line in lines[1:] if not 156.0 <= float(line.split(",")[0]) < 160.5]
    kept = [line for line in kept if not 118.5 <= float(line.split(",")[0]) < 118.6]
    files.recording.write_text("\n".join([lines[0], *kept]) + "\n", "utf-8")
    said(
        "--recording",
        files.recording,
        "--moves",
        files.moves,
        *_A1,
        "--test",
        "decaying",
        "-o",
        tmp_path / "r.json",
    )
    (test,) = read_resolution(tmp_path / "r.json").tests
    assert [move.measured is None for move in test.moves] == [number in {19, 20} for number in range(40)]
    others = [move.error_percent for move in test.moves if move.measured is not None]
    assert others == pytest.approx([0.0] * 38, abs=0.2)
    assert any("230 samples are missing" in text for text in test.flags)
    assert any(text.startswith("moves 20, 21: a gap of the recording swallows") for text in test.flags)


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
    with pytest.raises(UsageError, match=f"{missing.removeprefix('--')} is missing"):
        said(*(part for pair in words.items() for part in pair))


def test_a_zero_of_optics_that_is_not_stated_is_named(tmp_path: Path) -> None:
    command = decaying_commands(66)
    # As if the optics stood 8° from parallel where the count was zeroed: steps seem smaller by 1 − cos 8°, 1 %.
    files = write_test(tmp_path, command.tolist(), command.tolist(), zero_deg=8.0)
    assumed = _run(tmp_path, files, "--test", "decaying").tests[0]
    assert assumed.flags[-1].startswith(
        "the optics are taken as parallel where the displacement is 0, u = 1°"
    )
    assert assumed.moves[0].error_percent == pytest.approx(
        100.0 * (math.cos(math.radians(8.0)) - 1.0), abs=0.2
    )
    stated = _run(tmp_path, files, "--test", "decaying", "--zero-deg", 8, "--u-zero-deg", 0.1).tests[0]
    assert stated.moves[0].error_percent == pytest.approx(0.0, abs=0.02)
    assert not any("parallel" in flag for flag in stated.flags)


def test_a_zero_without_optics_is_refused(tmp_path: Path) -> None:
    files = write_test(tmp_path, [0.1] * 12, [0.1] * 12)
    given = ("--recording", files.recording, "--moves", files.moves, "-o", tmp_path / "r.json", *_A1[:-2])
    with pytest.raises(UsageError, match="are of angular optics: state --spacing-mm"):
        said(*given, "--test", "decaying", "--zero-deg", 1)
