"""The cell file of an emulated bench of one's own."""

import socket
from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.cell.templates import SCARA
from catseye.app.tui.session import EMULATED_BENCH
from catseye.app.tui.setup.emulators import emulated_cell, free_file, is_emulated


def test_it_loads_and_its_ports_are_free_and_its_own(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    path.write_text(emulated_cell(SCARA), encoding="utf-8")
    cell = load_cell(path).cell
    endpoints = [section.endpoint for section in cell.instruments.values()]
    ports = {int(endpoint.rpartition(":")[2]) for endpoint in endpoints}
    assert len(ports) == 4
    for port in ports:
        with socket.socket() as holder:
            holder.bind(("127.0.0.1", port))


def test_a_file_of_somebody_else_is_never_taken(tmp_path: Path) -> None:
    first = tmp_path / f"{EMULATED_BENCH}.toml"
    assert free_file(tmp_path, SCARA) == first
    first.write_text(emulated_cell(SCARA), encoding="utf-8")
    assert is_emulated(first, SCARA)
    assert free_file(tmp_path, SCARA) == first
    first.write_text('name = "lab-1"\n', encoding="utf-8")
    assert free_file(tmp_path, SCARA) == tmp_path / f"{EMULATED_BENCH}-2.toml"
