"""docs/write-a-driver.md: page and files agree, the example's tests pass, and its driver conforms."""

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from catseye.app.cell.scara.template import TEMPLATE
from tests.free_ports import at_ports, free_ports
from tests.system.plug_in import Example, environment, run_pytest, run_python

EXAMPLE = Example("driver", "write-a-driver.md")
run = run_pytest


@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """Return a copy of the example that looks installed."""
    return EXAMPLE.installed(tmp_path)


def test_the_page_shows_the_files_as_they_are() -> None:
    EXAMPLE.check_page()


def test_the_tests_of_the_example_pass(installed: Path) -> None:
    done = run(installed, "-q")
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture
def display(installed: Path) -> Iterator[str]:
    """Run the example's emulator; yield its endpoint."""
    process = subprocess.Popen(
        [sys.executable, "-m", "norra_ld5.emulator"],
        cwd=installed,
        env=environment(installed),
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        yield process.stdout.readline().strip()
    finally:
        process.kill()
        process.communicate()


def test_the_driver_of_the_example_conforms(installed: Path, display: str) -> None:
    options = ["--driver", "norra-ld5", "--endpoint", display, "--setting", "answer_timeout_s=0.3"]
    done = run(installed, "--pyargs", "catseye.app.testing.conformance", *options)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "conformance of norra-ld5, interferometer driver" in done.stdout
    assert re.search(r"\b3\d passed", done.stdout), done.stdout
    assert "not applicable: a_lost_beam_is_latched_until_the_next_zero: needs the truth" in done.stdout
    assert "simulated_is_said_by_the_device" not in done.stdout
    assert "another_serial_number_is_noticed" not in done.stdout


def test_the_suite_says_what_is_wrong_with_its_options(installed: Path) -> None:
    suite = ("--pyargs", "catseye.app.testing.conformance")
    for options, said in (
        ((), "needs --driver NAME"),
        (("--driver", "nora-ld5"), "did you mean 'norra-ld5'?"),
        (("--driver", "norra-ld5"), "no emulator for norra-ld5: give --endpoint URL"),
        (("--driver", "line-counter", "--setting", "profile"), "write key=value"),
    ):
        done = run(installed, *suite, *options)
        assert done.returncode == pytest.ExitCode.USAGE_ERROR, done.stdout
        assert said in done.stderr


def test_the_suite_explains_its_options(installed: Path) -> None:
    done = run(installed, "--pyargs", "catseye.app.testing.conformance", "--help")
    assert done.returncode == 0, done.stderr
    assert "--allow-motion" in done.stdout


def test_a_host_project_keeps_its_options_and_app_package(tmp_path: Path) -> None:
    package = tmp_path / "app"
    package.mkdir()
    (package / "__init__.py").write_text("NAME = 'host'\n", encoding="utf-8")
    (tmp_path / "conftest.py").write_text(
        "def pytest_addoption(parser):\n    parser.addoption('--driver')\n    parser.addoption('--endpoint')\n",
        encoding="utf-8",
    )
    (tmp_path / "test_host.py").write_text(
        "import app\n\ndef test_host(pytestconfig):\n    assert app.NAME == 'host'\n"
        "    assert pytestconfig.getoption('--driver') == 'firefox'\n",
        encoding="utf-8",
    )
    done = run(tmp_path, "-q", "-W", "error::ImportWarning", "--driver", "firefox", "test_host.py")
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_cell_file_may_name_the_driver_of_the_example(installed: Path, display: str) -> None:
    table = f'[interferometer]\ndriver = "norra-ld5"\nendpoint = "{display}"\n\n[interferometer.settings]\n'
    cell = installed / "cell.toml"
    for settings, code, said in (
        ("answer_timeout_s = 0.5", 3, "NORRA LD5 EMULATOR"),
        ("patience = 1", 2, "patience"),
    ):
        edited = re.sub(
            r"\[interferometer\]\n.*?(?=\n\[)", table + settings + "\n", TEMPLATE, flags=re.DOTALL
        )
        for old, new in at_ports(free_ports(4)):
            edited = edited.replace(old, new)
        cell.write_text(edited, encoding="utf-8")
        done = run_python(installed, "catseye", "doctor", "cell.toml")
        # The other devices are not there: exit code 3.
        assert done.returncode == code, done.stdout + done.stderr
        assert said in done.stdout + done.stderr
