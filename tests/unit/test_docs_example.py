"""The example and the pages about the Python interface do what they say."""

import ast
import importlib
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from catseye import calibration
from catseye.app.cli import cli
from tests.unit.app.results.serial_arm.tables import arm_file, poses_file, some_poses, tool_file

ROOT = Path(__file__).parents[2]
API = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", API, re.DOTALL)


def test_the_example_runs_and_its_statements_hold(capsys: pytest.CaptureFixture[str]) -> None:
    path = ROOT / "docs" / "examples" / "from_distances_to_decisions.py"
    runpy.run_path(str(path))
    assert "best three" in capsys.readouterr().out
    assert path.read_text(encoding="utf-8").count("\nassert ") >= 15


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with the result of a calibration."""
    words = ["--poses", str(poses_file(tmp_path, some_poses(), seed=1)), "--arm", str(arm_file(tmp_path))]
    words += ["--tool", str(tool_file(tmp_path)), "--model", "geometric", "-o", str(tmp_path / "arm.json")]
    done = CliRunner().invoke(cli, ["calibrate", *words])
    assert done.exit_code == 0, done.output
    return tmp_path


def test_the_blocks_of_the_page_run_one_after_the_other(folder: Path) -> None:
    names: dict[str, object] = {"folder": folder}
    for number, block in enumerate(BLOCKS):
        exec(compile(block, f"api.md, block {number + 1}", "exec"), names)
    assert len(BLOCKS) >= 5


def test_every_public_name_is_there_and_on_the_page() -> None:
    documented = set(re.findall(r"\b\w+\b", " ".join(re.findall(r"`[^`]*`", API))))
    for name in calibration.__all__:
        assert getattr(calibration, name).__name__ == name
        assert name in documented


def test_what_type_checkers_see_is_what_is_imported() -> None:
    tree = ast.parse(Path(calibration.__file__).read_text(encoding="utf-8"))
    seen = {
        alias.name: node.module
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        and node.module is not None
        and node.module.startswith("catseye.calibration.")
        for alias in node.names
    }
    assert sorted(seen) == sorted(calibration.__all__)
    for name, module in seen.items():
        assert getattr(calibration, name) is getattr(importlib.import_module(module), name)


def test_unknown_names_are_refused_as_of_any_module() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        calibration.nothing  # noqa: B018  # the access is what is tested


def test_the_package_alone_loads_no_numerical_library() -> None:
    code = (
        "import sys, catseye.calibration; assert not {'numpy', 'scipy'} & set(sys.modules);"
        "import catseye.calibration.scara.planar, catseye.calibration.scara.error_map;"
        "assert 'scipy' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT)
