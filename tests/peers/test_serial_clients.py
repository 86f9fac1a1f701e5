"""Public clients of serial lines, on pseudo-terminals."""

import socket
from dataclasses import replace
from urllib.parse import urlsplit

import pytest

from catseye.app.testing.bench import bench_config, bench_in_thread
from catseye.simulators.config import EmulatedDevice
from tests.patience import HANG_S
from tests.peers.environment import said_by
from tests.unit.simulators.benches import QUIET

MOVEIT = ("M1=1", "J1=J_CURR", "*NEXT", "MOV J1", "IF M1=1 THEN GOTO *NEXT", "END")
"""What the program of that name has to do for the client: follow J1 until M1 is 0."""


def line_of(endpoint: str) -> str:
    """Return the device of a serial endpoint."""
    return urlsplit(endpoint).path


def teach(endpoint: str, lines: tuple[str, ...]) -> None:
    """Write a program into the controller."""
    at = urlsplit(endpoint)
    texts = [f"{n}0 {text}" for n, text in enumerate(lines, 1)]
    with socket.create_connection((str(at.hostname), int(at.port or 0)), timeout=HANG_S) as pc:
        for command in (
            "CNTLON",
            "SRVON",
            "LOAD=MOVEIT",
            *(f"EDATA{text}" for text in texts),
            "SAVE",
            "CNTLOFF",
        ):
            pc.sendall(f"1;1;{command}\r".encode())
            answer = pc.recv(512)
            assert answer.startswith(b"QoK"), (command, answer)


def test_ctu_mitsubishi_moves_the_arm() -> None:
    devices = (
        EmulatedDevice("robot", "melfa-r3"),
        EmulatedDevice("line", "melfa-r3", "serial:///dev/ptmx?baud=38400&parity=E&stopbits=2"),
    )
    with bench_in_thread(replace(QUIET, devices=devices, axis_pattern=6)) as bench:
        teach(bench.endpoint("robot"), MOVEIT)
        before, after = said_by("melfa_serial.py", line_of(bench.endpoint("line")))
        assert bench.arm().alarm == 0
    assert before == pytest.approx([0.0, 0.0, 0.0, 0.0, 0.0, 0.0], abs=0.01)
    assert after == pytest.approx([10.0, 15.0, 20.0, -30.0, 0.0, 0.0], abs=0.02)


def test_ogameasure_reads_the_display() -> None:
    endpoint = "serial:///dev/ptmx?baud=9600&parity=E&bits=7&stopbits=2"
    devices = (EmulatedDevice("counter", "heidenhain-nd", endpoint),)
    with bench_in_thread(bench_config(*devices)) as bench:
        said = said_by("position_display.py", line_of(bench.endpoint("counter")))
        bench.fault("block_beam")
        lost = said_by("position_display.py", line_of(bench.endpoint("counter")))
    assert all(text.endswith("\r\n") for text in [*said.pop("identification"), *said.values()]), said
    assert all(text.startswith("\x02") for text in said.values()), said
    shown = float(said["shown"].strip("\x02\r\n ").replace(" ", ""))
    counts = int(said["position"].strip("\x02\r\n "))
    assert counts == pytest.approx(shown * 1e4, abs=20.0)
    assert said["error"] == "\x02" + " " * 13 + "\r\n"
    assert lost["shown"].split() == lost["error"].split() == ["\x02SIGNAL"]


def test_vaisala_pymodbus_reads_the_probe() -> None:
    endpoint = "serial:///dev/ptmx?baud=19200&stopbits=2"
    devices = (EmulatedDevice("air", "modbus-air", endpoint, {"device_id": 240}),)
    with bench_in_thread(replace(QUIET, devices=devices)) as bench:
        said = said_by("humidity_probe.py", line_of(bench.endpoint("air")))
    assert said["connected"]
    assert said["floats"][:2] == pytest.approx([50.0, 20.0], abs=1.0)
    assert said["integers"] == pytest.approx(said["floats"][:3], abs=0.05)


def test_a_place_of_melfapy_comes_through_the_data_link() -> None:
    devices = (EmulatedDevice("robot", "melfa-datalink"),)
    with bench_in_thread(replace(QUIET, devices=devices)) as bench:
        said = said_by("data_link.py", bench.endpoint("robot").rpartition(":")[2], *map(str, range(1, 7)))
        journal = bench.journal("robot")
    assert said == "1.0,2.0,3.0,4.0,5.0,6.0\r\n"
    assert any(said.strip() in entry.text for entry in journal), journal
