"""Bad input: what a person meets who gives the command something that cannot be done.

Each case is the real command in a process of its own. It has to end with the right exit code and a sentence that
names the file, line or device and the remedy, without a traceback, without talk on stdout and without half-written
files.
"""

import contextlib
import json
import math
import os
import socket
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from tests.free_ports import at_ports, free_ports
from tests.patience import HANG_S
from tests.system import forked

NODES1 = (-40, -20, 0, 20)
NODES2 = (20, 40, 60)
PLACES = {"P1": (650.0, -400.0), "P2": (680.0, 0.0), "P3": (640.0, 380.0)}
HEADER = "reflector,segment,theta1_deg,theta2_deg,direction1,direction2,displacement_mm"


@dataclass(frozen=True)
class Said:
    """How a command ended."""

    code: int
    out: str
    err: str


@pytest.fixture
def desk(tmp_path: Path) -> Path:
    """Return a folder with a good cell file of few nodes."""
    put_cell(tmp_path)
    return tmp_path


def put_cell(folder: Path, *changes: tuple[str, str]) -> Path:
    text = TEMPLATE
    few = (("theta1_deg = [", list(NODES1)), ("theta2_deg = [", list(NODES2)))
    for start, nodes in few:
        line = next(row for row in text.splitlines() if row.startswith(start))
        text = text.replace(line, f"{start}{', '.join(f'{node}.0' for node in nodes)}]")
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    path = folder / "cell.toml"
    path.write_text(text, encoding="utf-8")
    return path


def catseye(folder: Path, *arguments: str) -> Said:
    """Run the command in a folder and check what holds for every refusal."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("CATSEYE")}
    done = forked.run("catseye", arguments, cwd=folder, env=environment, limit_s=HANG_S)
    said = Said(done.returncode, done.stdout, done.stderr)
    assert "Traceback" not in said.out + said.err, said
    assert "internal error" not in said.err, said
    for line in said.out.splitlines():
        json.loads(line)
    return said


def assert_refused(said: Said, code: int, *parts: str) -> None:
    assert said.code == code, said
    for part in parts:
        assert part in said.err, said


def assert_answered(said: Said) -> None:
    """Check that the only JSON on stdout says what stderr ends with."""
    answer = json.loads(said.out)
    assert answer["exit_code"] == said.code
    assert said.err.endswith(f"catseye: {answer['error']}\n")


def files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("link1_mm = 325.0", "link1_m = 325.0", ("robot.link1_m", "did you mean link1_mm?")),
        ("link1_mm = 325.0", "link1_mm = -1.0", ("robot.link1_mm", "greater than 0")),
        ("x_mm = 680.0", 'x_mm = "far"', ("reflector[2].x_mm", "'far'")),
        ('format = "catseye-cell/1"', 'format = "catseye-cell/1', ("not a TOML file", "line 4")),
    ],
)
def test_a_wrong_cell_file_is_reported_with_line_and_key(
    tmp_path: Path, old: str, new: str, parts: tuple[str, ...]
) -> None:
    path = put_cell(tmp_path, (old, new))
    said = catseye(tmp_path, "run", "open-loop", "--cell", "cell.toml", "--json")
    assert_refused(said, 2, "cell.toml", *parts)
    if "TOML" not in parts[0]:
        line = next(
            i for i, row in enumerate(path.read_text(encoding="utf-8").splitlines(), 1) if row.startswith(new)
        )
        assert f"cell.toml:{line}:" in said.err
    assert_answered(said)
    assert files(tmp_path) == {"cell.toml"}


def test_a_missing_cell_file_names_the_command_that_writes_one(tmp_path: Path) -> None:
    for command in (("doctor", "no.toml"), ("config", "validate", "no.toml")):
        assert_refused(
            catseye(tmp_path, *command), 2, "no.toml: there is no such file", "catseye init no.toml"
        )
    assert files(tmp_path) == set()


@pytest.mark.parametrize("command", ["report", "export"])
def test_a_name_too_long_for_a_file_is_refused(tmp_path: Path, command: str) -> None:
    said = catseye(tmp_path, command, "x" * 5000, "-o", "out.csv")
    assert_refused(said, 2, "is too long for the name of a file")
    assert len(said.err) < 200


def test_unreachable_devices_are_named_by_doctor(tmp_path: Path) -> None:
    ports = free_ports(4)
    put_cell(tmp_path, *at_ports(ports))
    said = catseye(tmp_path, "doctor", "cell.toml", "--json")
    assert_refused(said, 3, "robot", "interferometer", "environment", "tracker")
    found = {device["device"]: device for device in json.loads(said.out)["devices"]}
    for device, port in zip(("robot", "interferometer", "environment", "tracker"), ports, strict=True):
        assert not found[device]["ok"]
        assert str(port) in found[device]["advice"][0]
    assert files(tmp_path) == {"cell.toml"}


def test_unreachable_devices_end_a_run_before_anything_moves(tmp_path: Path) -> None:
    ports = free_ports(4)
    put_cell(tmp_path, *at_ports(ports))
    said = catseye(tmp_path, "run", "open-loop", "--cell", "cell.toml", "--json")
    assert_refused(said, 3, str(ports[0]))
    events = [json.loads(line) for line in said.out.splitlines()]
    assert events[-1]["event"] == "run-ended"
    assert (events[-1]["status"], events[-1]["exit_code"]) == ("failed", 3)
    # The attempt is on record, whole and sealed, and holds no data.
    shown = catseye(tmp_path, "show", Path(events[-1]["path"]).name, "--json")
    assert json.loads(shown.out)["counts"]["points"] == 0
    assert catseye(tmp_path, "verify", Path(events[-1]["path"]).name).code == 0


@contextlib.contextmanager
def web_server() -> Iterator[int]:
    """Serve what answers every line like a web server on a free port."""
    ended = threading.Event()
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(0.05)

        def answer(connection: socket.socket) -> None:
            with connection:
                connection.settimeout(0.05)
                while not ended.is_set():
                    try:
                        if not connection.recv(4096):
                            return
                        connection.sendall(b"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n")
                    except TimeoutError:
                        continue
                    except OSError:
                        return

        def serve() -> None:
            talks: list[threading.Thread] = []
            while not ended.is_set():
                try:
                    connection, _ = server.accept()
                except TimeoutError:
                    continue
                talks.append(threading.Thread(target=answer, args=(connection,)))
                talks[-1].start()
            for talk in talks:
                talk.join()

        thread = threading.Thread(target=serve)
        thread.start()
        try:
            yield int(server.getsockname()[1])
        finally:
            ended.set()
            thread.join()


def test_a_wrong_device_behind_the_port_is_reported(tmp_path: Path) -> None:
    with web_server() as port:
        put_cell(tmp_path, *at_ports([port] * 4))
        said = catseye(tmp_path, "doctor", "cell.toml", "--json")
        assert_refused(said, 3, "robot", "interferometer", "environment", "tracker")
        for device in json.loads(said.out)["devices"]:
            assert not device["ok"]
            assert not device["simulated"]
            assert device["advice"]
            assert str(port) in device["advice"][0], device
        run = catseye(tmp_path, "run", "open-loop", "--cell", "cell.toml", "--json")
    assert_refused(run, 3, str(port))
    assert json.loads(run.out.splitlines()[-1])["status"] == "failed"


@pytest.mark.parametrize(
    ("changes", "arguments", "code", "parts"),
    [
        (
            [("j2 = [-145.0, 145.0]", "j2 = [-10.0, 50.0]")],
            ["open-loop"],
            5,
            ("J2 = 60°", "outside its limits -10°…50°", "[measurement]"),
        ),
        (
            [("j1 = [-170.0, 170.0]", "j1 = [-40.5, 170.0]")],
            ["open-loop"],
            5,
            ("take-up position", "J1 = -41°", "take_up_deg"),
        ),
        (
            [("j4 = [-360.0, 360.0]", "j4 = [-5.0, 5.0]")],
            ["open-loop"],
            5,
            ("J4", "widen [robot.limits_deg] j4"),
        ),
        (
            [("j1 = [-170.0, 170.0]", "j1 = [-20.0, 20.0]")],
            ["validation-path"],
            5,
            ("the path needs J1", "choose another path"),
        ),
        ([("x_mm = 680.0", "x_mm = 9000.0")], ["open-loop"], 2, ("reflector P2", "beam's range", "put the")),
        ([("x_mm = 680.0", "x_mm = -300.0")], ["open-loop"], 2, ("reflector P2", "column", "elsewhere")),
        ([("x_mm = 680.0", "x_mm = 545.0")], ["open-loop"], 2, ("reflector P2", "arm's way", "reach")),
        ([("x_mm = 680.0", "x_mm = 9000.0")], ["reflector-search"], 2, ("reflector P2", "poses", "place")),
        ([], ["validation-path", "--param", "y_to_mm=900"], 2, ("y = ", "out of reach", "550 mm")),
        ([], ["open-lop"], 2, ("no procedure 'open-lop'", "did you mean open-loop?")),
        ([], ["open-loop", "--param", "speed=3"], 2, ("--param speed", "known are reflectors, subdivide")),
        ([], ["open-loop", "--param", 'reflectors=["P9"]'], 2, ("reflector P9", "known: P1, P2, P3")),
        ([], ["open-loop", "--answers", "none.toml"], 2, ("none.toml",)),
    ],
)
def test_an_impossible_plan_is_refused_before_touching_any_device(
    tmp_path: Path, changes: list[tuple[str, str]], arguments: list[str], code: int, parts: tuple[str, ...]
) -> None:
    put_cell(tmp_path, *changes, *at_ports(free_ports(4)))
    said = catseye(tmp_path, "run", arguments[0], "--cell", "cell.toml", *arguments[1:])
    assert_refused(said, code, *parts)
    assert said.out == ""
    assert files(tmp_path) == {"cell.toml"}


def rows() -> list[list[str]]:
    """Return distances of the nominal arm at every node from every side, by plain trigonometry."""
    found = []
    for name, (px, py) in PLACES.items():
        for one, two in ((a, b) for a in NODES1 for b in NODES2):
            a, b = math.radians(one), math.radians(one + two)
            x, y = 325 * math.cos(a) + 225 * math.cos(b), 325 * math.sin(a) + 225 * math.sin(b)
            length = math.hypot(px - x, py - y) - 300.0
            found += [
                [name, "0", f"{one}", f"{two}", f"{s}", f"{t}", f"{length!r}"]
                for s in (1, -1)
                for t in (1, -1)
            ]
    return found


def put_points(folder: Path, table: list[list[str]], header: str = HEADER) -> None:
    text = "\n".join([header, *(",".join(row) for row in table)]) + "\n"
    (folder / "points.csv").write_text(text, encoding="utf-8")


def identified(folder: Path, output: str = "result.json") -> Said:
    return catseye(
        folder, "identify", "--points", "points.csv", "--cell", "cell.toml", "-o", output, "--json"
    )


def test_good_points_are_identified(desk: Path) -> None:
    put_points(desk, rows())
    said = identified(desk)
    assert said.code == 0, said
    assert json.loads(said.out)["link1_mm"]["value"] == pytest.approx(325.0, abs=1e-6)
    assert (desk / "result.json").is_file()


def changed(table: list[list[str]], row: int, column: int, value: str) -> list[list[str]]:
    table[row][column] = value
    return table


@pytest.mark.parametrize(
    ("table", "header", "code", "parts"),
    [
        (
            [row[:5] + row[6:] for row in rows()],
            HEADER.replace("direction2,", ""),
            2,
            ("points.csv:1: column direction2 is missing",),
        ),
        (changed(rows(), 6, 6, "nan"), HEADER, 2, ("points.csv:8: displacement_mm = 'nan'", "finite")),
        (changed(rows(), 6, 0, "P7"), HEADER, 2, ("points.csv:8: unknown reflector 'P7'", "P1, P2, P3")),
        (
            [row for row in rows() if row[2] != "0"],
            HEADER,
            1,
            ("no point touches Δθ1(0°, +), Δθ1(0°, −)", "[measurement]"),
        ),
        (
            [row for row in rows() if row[5] != "-1"],
            HEADER,
            1,
            ("no point touches Δθ2(20°, −)", "directions"),
        ),
        (changed(rows(), 6, 2, "-95"), HEADER, 2, ("θ1 -95", "outside the nodes")),
        (rows()[:10], HEADER, 1, ("10 usable distances", "measure more points")),
    ],
)
def test_points_that_cannot_be_used_are_refused(
    desk: Path, table: list[list[str]], header: str, code: int, parts: tuple[str, ...]
) -> None:
    put_points(desk, table, header)
    said = identified(desk)
    assert_refused(said, code, *parts)
    assert_answered(said)
    assert files(desk) == {"cell.toml", "points.csv"}


def test_a_missing_output_folder_is_a_storage_failure(desk: Path) -> None:
    put_points(desk, rows())
    said = identified(desk, "absent/result.json")
    assert_refused(said, 6, "absent/result.json: cannot be written", "make it first")
    assert_answered(said)
    assert files(desk) == {"cell.toml", "points.csv"}


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["init", "cell.toml"], ("cell.toml exists already", "choose another name")),
        (["init", "absent/cell.toml"], ("absent is not a folder",)),
        (["report", "cell.toml", "-o", "page.pdf"], ("page.pdf: a report is an HTML page", "page.html")),
        (["report", "cell.toml", "-o", "page.html"], ("cell.toml: is not a catseye-result/1 file",)),
        (["identify", "-o", "r.json"], ("--points FILE with --cell FILE",)),
        (
            ["identify", "--points", "none.csv", "--cell", "cell.toml", "-o", "r.json"],
            ("none.csv: there is no",),
        ),
        (["export", "none", "-o", "points.csv"], ("no run 'none'",)),
        (["emulate", "cell.toml", "--truth", "none.json"], ("none.json",)),
    ],
)
def test_commands_that_cannot_be_carried_out_change_nothing(
    desk: Path, arguments: list[str], parts: tuple[str, ...]
) -> None:
    before = (desk / "cell.toml").read_bytes()
    said = catseye(desk, *arguments)
    assert_refused(said, 2, *parts)
    assert said.out == ""
    assert files(desk) == {"cell.toml"}
    assert (desk / "cell.toml").read_bytes() == before
