"""In which order files reach the disk and get their names."""

import os
from pathlib import Path

import pytest

Happening = tuple[str, str]
"""`sync` or `name`, and the name of the file or folder."""


def recorded(monkeypatch: pytest.MonkeyPatch) -> list[Happening]:
    """Return a list that each fsync and each renaming is added to."""
    happened: list[Happening] = []
    fsync, rename, replace = os.fsync, Path.rename, Path.replace

    def synced(descriptor: int) -> None:
        happened.append(("sync", Path(os.readlink(f"/proc/self/fd/{descriptor}")).name))
        fsync(descriptor)

    def renamed(path: Path, target: Path) -> Path:
        happened.append(("name", Path(target).name))
        return rename(path, target)

    def replaced(path: Path, target: Path) -> Path:
        happened.append(("name", Path(target).name))
        return replace(path, target)

    monkeypatch.setattr(os, "fsync", synced)
    monkeypatch.setattr(Path, "rename", renamed)
    monkeypatch.setattr(Path, "replace", replaced)
    return happened
