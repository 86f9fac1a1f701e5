"""Log files stay readable line by line, whatever the disk took of a line."""

import json
import os
from io import FileIO
from pathlib import Path

import pytest

from catseye.app.store.lines import JsonLines
from tests.unit.app.store.fakes import TickingClock


class NarrowDisk:
    """Takes so many bytes of the next line, and all of those after it."""

    def __init__(self, file: FileIO, room_bytes: int) -> None:
        self._file = file
        self._room_bytes: int | None = room_bytes

    def write(self, data: bytes) -> int:
        room_bytes, self._room_bytes = self._room_bytes, None
        taken = self._file.write(data[:room_bytes])
        assert taken is not None
        return taken

    @property
    def closed(self) -> bool:
        return self._file.closed

    def close(self) -> None:
        self._file.close()


def on_narrow_disk(lines: JsonLines, path: Path, room_bytes: int, patch: pytest.MonkeyPatch) -> None:
    lines.close()
    patch.setattr(lines, "_file", NarrowDisk(FileIO(path, "ab"), room_bytes))


def opened(path: Path) -> tuple[JsonLines, list[OSError]]:
    failures: list[OSError] = []
    return JsonLines(path, TickingClock(), failures.append), failures


def fields(path: Path) -> list[object]:
    """Return the numbers of the whole lines."""
    found = []
    for line in path.read_text().splitlines():
        try:
            found.append(json.loads(line)["n"])
        except ValueError:
            found.append("half")
    return found


@pytest.mark.parametrize("room_bytes", [1, 10, 30])
def test_a_half_line_is_ended_before_the_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, room_bytes: int
) -> None:
    lines, failures = opened(tmp_path / "wire.log")
    lines.write(n=1)
    on_narrow_disk(lines, tmp_path / "wire.log", room_bytes, monkeypatch)
    for number in (2, 3, 4):
        lines.write(n=number)
    lines.close()
    assert fields(tmp_path / "wire.log") == [1, "half", 3, 4]
    assert len(failures) == 1


def test_a_line_of_which_nothing_was_taken_leaves_no_gap(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines, failures = opened(tmp_path / "wire.log")
    on_narrow_disk(lines, tmp_path / "wire.log", 0, monkeypatch)
    lines.write(n=1)
    lines.write(n=2)
    lines.close()
    assert fields(tmp_path / "wire.log") == [2]
    assert len(failures) == 1


def test_a_half_line_of_an_earlier_process_is_ended(tmp_path: Path) -> None:
    path = tmp_path / "wire.log"
    path.write_bytes(b'{"t":"2026-01-02","n":1}\n{"t":"20')
    lines, _ = opened(path)
    lines.write(n=2)
    lines.close()
    assert fields(path) == [1, "half", 2]


def test_nothing_is_added_to_whole_lines(tmp_path: Path) -> None:
    path = tmp_path / "wire.log"
    for number in (1, 2):
        lines, _ = opened(path)
        lines.write(n=number)
        lines.close()
    assert fields(path) == [1, 2]
    assert os.stat(path).st_size == len(path.read_text().rstrip("\n")) + 1
