"""docs/write-a-procedure.md: page and files agree, the example's tests pass, and it runs on an emulated bench."""

import csv
from collections.abc import Iterator
from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.testing.process import bench_in_process
from tests.free_ports import at_ports, free_ports
from tests.system.plug_in import Example, run_pytest, run_python

EXAMPLE = Example("procedure", "write-a-procedure.md")


@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """Return a copy of the example that looks installed."""
    return EXAMPLE.installed(tmp_path)


@pytest.fixture
def cell(installed: Path) -> Iterator[Path]:
    """Run an emulated bench; yield its cell file, next to the example."""
    text = TEMPLATE
    for old, new in at_ports(free_ports(4)):
        text = text.replace(old, new)
    file = installed / "cell.toml"
    file.write_text(text, encoding="utf-8")
    with bench_in_process(file):
        yield file


def test_the_page_shows_the_files_as_they_are() -> None:
    EXAMPLE.check_page()


def test_the_tests_of_the_example_pass(installed: Path) -> None:
    done = run_pytest(installed, "-q")
    assert done.returncode == 0, done.stdout + done.stderr


def test_its_declarations_appear(installed: Path) -> None:
    told = run_python(installed, "catseye", "procedures", "norra-readback")
    assert told.returncode == 0, told.stderr
    for text in (
        "One axis moves to and fro",
        "--param cycles=10",
        "Travel, deg: to either side of zero, deg",
        "more than 0; default 0.01",
    ):
        assert text in told.stdout
    asked = run_python(installed, "catseye", "prompts", "norra-readback")
    assert "nobody is in the arm's way" in asked.stdout


def test_it_runs_and_its_data_can_be_used(installed: Path, cell: Path) -> None:
    run = ("catseye", "run", "norra-readback", "--cell", cell.name, "--param", "cycles=2")
    rehearsed = run_python(installed, *run, "--dry-run")
    assert "3 steps, 4 moves" in rehearsed.stderr
    done = run_python(installed, *run)
    assert done.returncode == 0, done.stderr
    assert "deviation +0.0000° ± 0.0000°, largest 0.0000°" in done.stderr
    record = Path(done.stdout.strip()).name
    shown = run_python(installed, "catseye", "show", record)
    assert "3 steps, 4 read_back" in shown.stdout
    assert "Result\n  · deviation +0.0000° ± 0.0000°, largest 0.0000°" in shown.stdout
    told = run_python(installed, "catseye", "report", record, "-o", "page.html")
    assert told.returncode == 0, told.stderr
    page = (installed / "page.html").read_text(encoding="utf-8")
    assert "deviation +0.0000° ± 0.0000°" in page
    assert "Nothing was identified" not in page
    out = run_python(installed, "catseye", "export", record, "--format", "csv", "-o", "rows.csv")
    assert out.returncode == 0, out.stderr
    rows = list(csv.DictReader((installed / "rows.csv").read_text(encoding="utf-8").splitlines()))
    assert [float(row["commanded_deg"]) for row in rows] == [-2.0, 2.0, -2.0, 2.0]


def test_an_error_of_its_own_is_shown_where_it_happened(
    installed: Path, cell: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = installed / "norra_readback" / "procedure.py"
    text = source.read_text(encoding="utf-8")
    wrong = text.replace("Reading(cycle=cycle + 1,", "Reading(cycle=str(cycle),")
    assert wrong != text
    source.write_text(wrong, encoding="utf-8")
    monkeypatch.setenv("CATSEYE_DEBUG", "1")
    done = run_python(installed, "catseye", "run", "norra-readback", "--cell", cell.name)
    assert done.returncode == 70, done.stderr
    assert "a Reading cannot be kept: read_back.cycle = '0' is a str: it takes an int" in done.stderr
    assert "norra_readback/procedure.py" in done.stderr
