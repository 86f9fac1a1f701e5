"""What docs/unattended.md shows can be used as it stands there."""

import configparser
import re
import shlex
import shutil
import subprocess
from pathlib import Path
from typing import get_args

import pytest

from catseye.app.campaign.judging import exit_code_of_job
from catseye.app.campaign.load import load_campaign
from catseye.app.campaign.model import Campaign, Limit, StageEntry
from catseye.app.cli.lazy import load_command
from catseye.app.protocol.campaign_events import Code, StageVerdict

DOCS = Path(__file__).parents[4] / "docs"
PAGE = (DOCS / "unattended.md").read_text(encoding="utf-8")
EXAMPLES = DOCS / "examples" / "unattended"


def called(line: str) -> list[str]:
    """Return the words after `catseye campaign`."""
    words = shlex.split(line.replace("\\%", "%"))
    return words[words.index("campaign") + 1 :]


def require_known_options(words: list[str]) -> None:
    known = {option for each in load_command("campaign").params for option in each.opts}
    assert {word for word in words if word.startswith("--")} <= known


def test_the_example_is_a_campaign() -> None:
    loaded = load_campaign(EXAMPLES / "night.toml")
    assert [each.name for each in loaded.campaign.stage][:3] == ["reflector-search", "open-loop", "identify"]
    assert loaded.campaign.stage[2].limit[0].max == 20.0


def test_every_key_of_the_file_is_explained() -> None:
    table = PAGE.partition("## The campaign file")[2].partition("\n## ")[0]
    explained = set(re.findall(r"`\[*([a-z_.]+)\]*`", table))
    keys = {*Campaign.model_fields, *StageEntry.model_fields, *Limit.model_fields}
    renamed = {"stage": "stage", "limit": "stage.limit"}
    assert {renamed.get(key, key) for key in keys} <= explained


def test_every_code_has_its_line() -> None:
    table = PAGE.partition("| code | exit code |")[2].partition("\n\n")[0]
    assert set(re.findall(r"`([a-z-]+)`", table)) >= set(get_args(Code))


def test_every_code_ends_a_job_as_the_page_says() -> None:
    table = PAGE.partition("| code | exit code |")[2].partition("\n\n")[0]
    rows = re.findall(r"^\| (`.*?`) \| (\d+) \|", table, re.MULTILINE)
    said = {code: int(number) for codes, number in rows for code in re.findall(r"`([a-z-]+)`", codes)}
    for code in set(get_args(Code)) - {"passed"}:
        verdict = StageVerdict(stage="search", verdict="not-done", code=code, text="")
        assert exit_code_of_job(verdict) == said[code], code
    assert exit_code_of_job(None) == said["passed"]


def test_the_line_for_cron_is_a_command() -> None:
    (line,) = re.findall(r"^0 20 .*$", PAGE, re.MULTILINE)
    require_known_options(called(line.partition(" >> ")[0]))
    assert "\\%F" in line  # cron takes a bare % for the end of the command


def test_the_service_starts_a_campaign() -> None:
    unit = configparser.ConfigParser(strict=False, interpolation=None, delimiters=("=",))
    unit.optionxform = str  # type: ignore[assignment,method-assign]  # names of units have capitals
    unit.read(EXAMPLES / "lab-night.service")
    shell = shlex.split(unit["Service"]["ExecStart"])
    require_known_options(called(shell[-1].partition(" >> ")[0]))
    assert unit["Service"]["KillMode"] == "mixed"


@pytest.mark.parametrize("name", ["lab-night.service", "lab-night.timer"])
def test_systemd_takes_the_units(name: str, tmp_path: Path) -> None:
    verify = shutil.which("systemd-analyze")
    if verify is None:
        # Where there is no systemd its own rules cannot be asked; every section and key has to be one of its own.
        text = (EXAMPLES / name).read_text(encoding="utf-8")
        assert re.findall(r"^\[(\w+)\]$", text, re.MULTILINE)[0] == "Unit"
        return
    for unit in EXAMPLES.glob("lab-night.*"):
        text = unit.read_text(encoding="utf-8").replace("/bin/sh", shutil.which("sh") or "/bin/sh")
        (tmp_path / unit.name).write_text(re.sub(r"^User=.*\n", "", text, flags=re.MULTILINE))
    done = subprocess.run([verify, "verify", tmp_path / name], capture_output=True, text=True, check=False)
    complaints = [line for line in done.stderr.splitlines() if "lab-night" in line]
    assert complaints == []
