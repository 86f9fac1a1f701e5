"""Names of runs and jobs lead nowhere but into their folder."""

from pathlib import Path

import pytest

from catseye.app.campaign.job import Job
from catseye.app.campaign.load import load_campaign
from catseye.app.errors import StorageError, UsageError
from catseye.app.store.catalog import resolve_run
from catseye.app.store.run_names import run_name
from catseye.drivers.roles.clock import SystemClock

PATHS = [
    "../other",
    "/etc/passwd",
    "a\0b",
    "..",
    ".",
    "",
    "a/b",
    "x" * 5000,
    "~root",
    "\udc80",
    "a\nb",
    "-rf",
]


@pytest.mark.parametrize("name", [*PATHS, "../20260101T000000Z_search_1a2b3c"])
def test_no_run_is_found_by_a_path_without_one(tmp_path: Path, name: str) -> None:
    (tmp_path / "runs").mkdir()
    with pytest.raises((UsageError, StorageError), match=r"no run|File name too long"):
        resolve_run(tmp_path / "runs", name)


@pytest.mark.parametrize("name", PATHS)
def test_no_path_is_the_id_of_a_job(tmp_path: Path, name: str) -> None:
    loaded = load_campaign(Path("scara-day"))
    with pytest.raises(UsageError, match="--job"):
        Job.seen(tmp_path, name, loaded, "cell", SystemClock().now_utc())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", PATHS)
def test_no_path_is_the_name_of_a_run(name: str) -> None:
    assert run_name(name) is None
