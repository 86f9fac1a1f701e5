"""Figures of finished stages are found out once, and again when a file behind one changes."""

import os
from pathlib import Path

import pytest

from catseye.app.results.readiness.headline import Headline, Headlines, Written
from catseye.app.results.readiness.remembered import REMEMBERED, Remembered
from catseye.app.store.seal import DATABASE

FOUND = Headline("+0.08 of ±0.2 mrad")


class Looks:
    """Counts what is found out; a look of its own for each survey."""

    def __init__(self, root: Path, found: Headline | None = FOUND) -> None:
        self.root, self.found = root, found
        self.looked_at: list[Path] = []

    def again(self, *paths: Path) -> list[Headline | None]:
        """Ask for the figures of runs as one survey does."""
        remembered = Remembered(self.root, lambda: Headlines(self.find_out))
        found = [remembered.headlines.of_run(path) for path in paths]
        remembered.keep()
        return found

    def find_out(self, path: Path) -> Headline | None:
        """Evaluate a file."""
        self.looked_at.append(path)
        return self.found


def a_run(root: Path, name: str = "run") -> Path:
    path = root / name
    path.mkdir()
    (path / DATABASE).write_bytes(b"as it was")
    return path


@pytest.mark.parametrize("found", [FOUND, Headline("cannot be judged", holds=False), None])
def test_a_run_is_evaluated_once(tmp_path: Path, found: Headline | None) -> None:
    run, looks = a_run(tmp_path), Looks(tmp_path, found)
    assert looks.again(run) == looks.again(run) == [found]
    assert looks.looked_at == [run]


def test_nothing_is_loaded_for_what_is_known(tmp_path: Path) -> None:
    run = a_run(tmp_path)
    Looks(tmp_path).again(run)

    def load() -> Headlines:
        pytest.fail("nothing has to be found out")

    assert Remembered(tmp_path, load).headlines.of_run(run) == FOUND


def test_a_changed_run_is_evaluated_anew(tmp_path: Path) -> None:
    run, looks = a_run(tmp_path), Looks(tmp_path)
    looks.again(run)
    (run / DATABASE).write_bytes(b"as it is now")
    looks.found = Headline("another")
    assert looks.again(run) == [Headline("another")]


def test_a_run_that_is_written_is_evaluated_anew(tmp_path: Path) -> None:
    run, looks = a_run(tmp_path), Looks(tmp_path)
    looks.again(run)
    (run / f"{DATABASE}-wal").write_bytes(b"more")
    looks.again(run)
    assert looks.looked_at == [run, run]


def test_a_time_of_change_alone_counts(tmp_path: Path) -> None:
    run, looks = a_run(tmp_path), Looks(tmp_path)
    looks.again(run)
    os.utime(run / DATABASE, (1.0, 1.0))
    looks.again(run)
    assert looks.looked_at == [run, run]


@pytest.mark.parametrize(
    "text", ["", "{", "[]", '{"software": "catseye 0", "figures": {}}', '{"figures": {"run": 1}}']
)
def test_a_damaged_file_is_ignored(tmp_path: Path, text: str) -> None:
    run, looks = a_run(tmp_path), Looks(tmp_path)
    (tmp_path / REMEMBERED).write_text(text, encoding="utf-8")
    assert looks.again(run) == looks.again(run) == [FOUND]
    assert looks.looked_at == [run]


def test_the_file_may_be_deleted(tmp_path: Path) -> None:
    run, looks = a_run(tmp_path), Looks(tmp_path)
    looks.again(run)
    (tmp_path / REMEMBERED).unlink()
    assert looks.again(run) == [FOUND]
    assert looks.looked_at == [run, run]


def test_another_version_of_the_program_looks_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run, looks = a_run(tmp_path), Looks(tmp_path)
    looks.again(run)
    monkeypatch.setattr("catseye.app.results.readiness.remembered.SOFTWARE", "catseye 99")
    looks.again(run)
    assert looks.looked_at == [run, run]


def test_a_missing_folder_is_not_made(tmp_path: Path) -> None:
    Looks(tmp_path / "none").again(tmp_path / "none" / "run")
    assert not (tmp_path / "none").exists()


def test_a_validation_follows_its_result(tmp_path: Path) -> None:
    run, looks = a_run(tmp_path), Looks(tmp_path)
    page, result = tmp_path / "validation.html", tmp_path / "result.json"
    for file in (page, result):
        file.write_text("as it was", encoding="utf-8")

    def look() -> None:
        remembered = Remembered(
            tmp_path, lambda: Headlines(of_written=lambda written: looks.find_out(written.file))
        )
        remembered.headlines.of_written(Written("validate", page, (result,), (run,)))
        remembered.keep()

    look()
    look()
    assert looks.looked_at == [page]
    result.write_text("as it is now", encoding="utf-8")
    look()
    assert looks.looked_at == [page, page]
