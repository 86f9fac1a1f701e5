"""Each row of the table of exit codes, by the command itself in a process of its own."""

import os
import signal
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from tests.patience import HANG_S
from tests.system import forked
from tests.system.command import SPEED, Emulated, begun, catseye, emulated, environment, last_run
from tests.unit.app.cli.arms import bare, stored, text_file

PATH = "theta1_deg,theta2_deg,direction1,direction2\n45,60,1,1\n"
FAR = (
    "x_mm,y_mm,x_meas_mm,y_meas_mm\n300,300,300.5,300\n310,290,310,290.9\n330,250,330,250\n300,200,300,200\n"
)
SHORT = ("--param", "step_mm=50", "--param", "y_from_mm=300", "--param", "y_to_mm=400")


@dataclass(frozen=True)
class Case:
    """A way to an exit code.

    Attributes:
        code: that is due.
        ended: does it in a folder with an emulated bench, and returns how it ended.
    """

    code: int
    ended: Callable[[Emulated], "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with emulated(tmp_path_factory.mktemp("codes"), "--seed", "3") as running:
        yield running


def done(bench: Emulated) -> "subprocess.CompletedProcess[str]":
    return catseye("config", "validate", bench.cell, cwd=bench.cell.parent)


def failed_criterion(bench: Emulated) -> "subprocess.CompletedProcess[str]":
    folder = bench.cell.parent
    measured = text_file(folder, FAR, "measured.csv")
    result = stored(folder, bare())
    return catseye("validate", result, "--measured", measured, "--limit-um", "1", cwd=folder)


def wrong_cell(bench: Emulated) -> "subprocess.CompletedProcess[str]":
    cell = text_file(bench.cell.parent, TEMPLATE.replace("link1_mm", "link_1_mm"), "wrong.toml")
    return catseye("config", "validate", cell, cwd=bench.cell.parent)


def unknown_option(bench: Emulated) -> "subprocess.CompletedProcess[str]":
    return catseye("runs", "--nonsense", cwd=bench.cell.parent)


def silent_device(bench: Emulated) -> "subprocess.CompletedProcess[str]":
    # Nobody listens on the first port of all.
    text = bench.cell.read_text(encoding="utf-8")
    endpoint = next(line for line in text.splitlines() if line.startswith("endpoint"))
    cell = text_file(bench.cell.parent, text.replace(endpoint, 'endpoint = "tcp://127.0.0.1:1"'), "off.toml")
    return catseye("doctor", cell, cwd=bench.cell.parent)


def unanswered(bench: Emulated) -> "subprocess.CompletedProcess[str]":
    options = ("--search", "none", "--speed", SPEED, "--param", "instrument=file", *SHORT)
    return catseye("run", "validation-path", "--cell", bench.cell, *options, cwd=bench.cell.parent)


def beyond_limits(bench: Emulated) -> "subprocess.CompletedProcess[str]":
    folder = bench.cell.parent
    narrow = bench.cell.read_text(encoding="utf-8").replace("j1 = [-170.0, 170.0]", "j1 = [-170.0, 44.0]")
    options = ("--path", text_file(folder, PATH), "--cell", text_file(folder, narrow, "narrow.toml"))
    return catseye("compensate", stored(folder, bare()), *options, "-o", folder / "out.csv", cwd=folder)


def changed_run(bench: Emulated) -> "subprocess.CompletedProcess[str]":
    unanswered(bench)
    name = last_run(bench.cell.parent, "validation-path")
    log = next(bench.cell.parent.rglob(name)) / "wire.log"
    log.chmod(0o644)
    log.write_text("nothing happened", encoding="utf-8")
    return catseye("verify", name, cwd=bench.cell.parent)


def fault(bench: Emulated) -> "subprocess.CompletedProcess[str]":
    folder = bench.cell.parent
    return forked.run("tests.system.faulty", ["procedures"], cwd=folder, env=environment(), limit_s=HANG_S)


def signalled(*numbers: int) -> Callable[[Emulated], "subprocess.CompletedProcess[str]"]:
    def ended(bench: Emulated) -> "subprocess.CompletedProcess[str]":
        command = ("run", "open-loop", "--cell", bench.cell, "--search", "none", "--speed", SPEED, "--json")
        with begun(*command, cwd=bench.cell.parent) as (process, lines):
            for number, due in zip(numbers, ('"step-done"', '"HELD"'), strict=False):
                next(line for line in lines if due in line)
                process.send_signal(number)
            lines.read()
            return subprocess.CompletedProcess(command, process.wait(HANG_S), "", "")

    return ended


def unread(bench: Emulated) -> "subprocess.CompletedProcess[str]":
    source, sink = os.pipe()
    os.close(source)
    with open(sink, "wb") as out, tempfile.TemporaryFile() as err:
        command = ("config", "show", bench.cell)
        process = forked.Forked(
            "catseye", command, cwd=bench.cell.parent, env=environment(), out=out, err=err
        )
        return subprocess.CompletedProcess(command, process.wait(HANG_S), "", "")


TABLE = {
    "done": Case(0, done),
    "criterion failed": Case(1, failed_criterion),
    "configuration": Case(2, wrong_cell),
    "usage": Case(2, unknown_option),
    "device": Case(3, silent_device),
    "unanswered prompt": Case(4, unanswered),
    "limit": Case(5, beyond_limits),
    "storage": Case(6, changed_run),
    "fault of the program": Case(70, fault),
    "interrupted": Case(130, signalled(signal.SIGINT, signal.SIGINT)),
    "reader gone": Case(141, unread),
    "terminated": Case(143, signalled(signal.SIGTERM)),
}


@pytest.mark.parametrize("row", TABLE)
def test_each_ending_has_its_exit_code(bench: Emulated, row: str) -> None:
    ended = TABLE[row].ended(bench)
    assert ended.returncode == TABLE[row].code, ended.stderr


def test_the_documented_table_is_the_tested_one() -> None:
    text = (Path(__file__).parents[2] / "docs" / "files.md").read_text(encoding="utf-8")
    table = text.partition("## Exit codes")[2].partition("\n\nstdout")[0]
    documented = [line.split("|")[1].strip() for line in table.splitlines() if line.startswith("|")]
    assert [int(code) for code in documented if code.isdigit()] == sorted(
        {one.code for one in TABLE.values()}
    )
