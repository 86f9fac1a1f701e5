"""Which results there are in folders."""

import os
from pathlib import Path

from catseye.app.results.result_files import ResultFiles
from catseye.app.results.scara.result import read_result
from tests.unit.app.tui.stored_results import write_results

READERS = {"catseye-result": read_result}


def test_newest_first_unreadable_at_the_end_others_passed_over(tmp_path: Path) -> None:
    write_results(tmp_path)
    (tmp_path / "below").mkdir()
    write_results(tmp_path / "below")
    found = ResultFiles([tmp_path, tmp_path / "none", tmp_path], READERS).look()
    names = [file.path.name for file in found]
    assert names == ["error-map.json", "later.json", "conventional.json", "broken.json"]
    assert found[0].result is not None
    assert found[0].result.link1_mm.value == 325.0123
    assert found[3].result is None
    assert "link1_mm: Field required" in found[3].fault


def test_only_what_changed_is_read_anew(tmp_path: Path) -> None:
    write_results(tmp_path)
    shelf = ResultFiles([tmp_path], READERS)
    first = shelf.look()
    os.utime(tmp_path / "later.json", (2e9, 2e9))
    (tmp_path / "conventional.json").unlink()
    second = shelf.look()
    assert [file.path.name for file in second] == ["later.json", "error-map.json", "broken.json"]
    assert second[1] is first[0]
    assert second[0] is not first[1]


def test_what_is_no_ordinary_file_is_passed_over(tmp_path: Path) -> None:
    (tmp_path / "folder.json").mkdir()
    os.mkfifo(tmp_path / "pipe.json")
    assert ResultFiles([tmp_path], READERS).look() == []
