"""What TAB offers, as the scripts of the shells ask for it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from catseye.app.cli import cli

NAMES = ["20261101T080000Z_warmup_0a1b2c", "20261102T080000Z_open-loop_beef01"]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stand where two runs and a result lie."""
    for name in (*NAMES, "notes"):
        (tmp_path / "catseye-runs" / name).mkdir(parents=True)
    (tmp_path / "map.json").write_text("{}", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CATSEYE_RUNS", raising=False)
    return tmp_path


def offered(typed: str, shell: str = "bash") -> list[str]:
    """Return what is offered behind a command line."""
    number = str(len(typed.split(" ")) - 1)
    asked = {"COMP_WORDS": typed, "COMP_CWORD": number, "_TYPER_COMPLETE_ARGS": typed}
    words = {**asked, "_CATSEYE_COMPLETE": f"complete_{shell}", "_TYPER_COMPLETE_FISH_ACTION": "get-args"}
    return CliRunner().invoke(cli, prog_name="catseye", env=words).output.strip("\n").splitlines()


def test_procedures_are_offered_by_name() -> None:
    assert {"warmup", "open-loop", "tracker-calibration"} <= set(offered("catseye run "))
    assert offered("catseye run open") == ["open-loop"]


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    "command", ["show", "verify", "resume", "attach", "identify", "diagnose", "calibrate", "resolution"]
)
def test_runs_are_offered_by_name(command: str) -> None:
    assert offered(f"catseye {command} 2026") == NAMES


@pytest.mark.usefixtures("folder")
def test_a_run_is_offered_by_its_id() -> None:
    assert offered("catseye show bee") == ["beef01"]


def test_runs_of_the_stated_folder_are_offered(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir("/")
    assert offered(f"catseye show --runs {folder / 'catseye-runs'} 20261102") == NAMES[1:]


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("command", ["report", "export"])
def test_results_are_offered_beside_runs(command: str) -> None:
    assert offered(f"catseye {command} ") == [*NAMES, "map.json"]
    assert offered(f"catseye {command} ma") == ["map.json"]


@pytest.mark.usefixtures("folder")
def test_runs_are_offered_as_aim() -> None:
    assert offered("catseye run open-loop --search ") == ["auto", "none", *NAMES]


def test_parameters_of_the_procedure_are_offered() -> None:
    assert {"closures=", "reflectors=", "j4_reversal="} <= set(offered("catseye run open-loop --param "))
    assert "closures=" not in offered("catseye run warmup --param ")


def test_one_parameter_left_shows_what_it_takes() -> None:
    assert offered("catseye run open-loop --param clos") == ["closures=", "closures=2"]
    assert offered("catseye run open-loop --param j4_") == [
        "j4_reversal=",
        "j4_reversal=false",
        "j4_reversal=true",
    ]


def test_fish_shows_what_a_parameter_means() -> None:
    (line,) = [
        line for line in offered("catseye run open-loop --param ", "fish") if line.startswith("closures=")
    ]
    assert line == "closures=\treturns to an early pose for each reflector, which show drift"


def test_zsh_takes_a_value_behind_its_name() -> None:
    assert '"j4_reversal=true"' in "".join(offered("catseye run open-loop --param j4_reversal=t", "zsh"))


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    "typed", ["catseye run nonsense --param ", "catseye run --param ", "catseye show --runs /dev/null/x "]
)
def test_nothing_is_offered_where_nothing_fits(typed: str) -> None:
    assert offered(typed) == []


@pytest.mark.parametrize(
    ("typed", "heavy"),
    [
        ("catseye run ", ("numpy", "scipy", "textual", "matplotlib")),
        ("catseye show ", ("numpy", "scipy", "textual", "matplotlib")),
        ("catseye run open-loop --param ", ("scipy", "textual", "matplotlib")),
    ],
)
def test_completion_imports_nothing_heavy(typed: str, heavy: tuple[str, ...]) -> None:
    code = f"""
import os, sys
os.environ.update(_CATSEYE_COMPLETE="complete_bash", COMP_WORDS={typed!r}, COMP_CWORD="{typed.count(" ")}")
from catseye.app.cli import cli
try:
    cli(prog_name="catseye")
except SystemExit:
    print([name for name in {heavy!r} if name in sys.modules], file=sys.stderr)
"""
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ, capture_output=True, text=True, check=True
    )
    assert done.stderr == "[]\n"
