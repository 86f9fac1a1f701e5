"""Closing a run's directory: read-only files and a manifest of their contents."""

import hashlib
import json
import os
import stat
from pathlib import Path

from pydantic import BaseModel, ValidationError

from app.engine.crash_points import crash_point
from app.errors import StorageError

MANIFEST = "manifest.json"
DATABASE = "run.sqlite"
WIRE_LOG = "wire.log"
APP_LOG = "app.log"

# SQLite's shared memory file is an index of the log beside it: it carries no data and changes when read.
_IGNORED = {MANIFEST, f"{MANIFEST}.tmp", f"{DATABASE}-shm"}


class SealedFile(BaseModel):
    """One file of a sealed run.

    Attributes:
        sha256: hexadecimal digest.
        bytes: size.
    """

    sha256: str
    bytes: int


class Manifest(BaseModel):
    """What a run's directory holds.

    Attributes:
        format: name and version of this format.
        run: the run's name.
        created_utc: when it was sealed.
        files: every file, by name.
    """

    format: str = "catseye-manifest/1"
    run: str
    created_utc: str
    files: dict[str, SealedFile]


def digest(directory: Path) -> dict[str, SealedFile]:
    """Return the digests of a run's files."""
    files = sorted(path for path in directory.iterdir() if path.is_file() and path.name not in _IGNORED)
    return {path.name: _digest_file(path) for path in files}


def seal(directory: Path, created_utc: str) -> None:
    """Write the manifest so that it is either complete or absent, and take the write permission away."""
    for path in directory.iterdir():
        _sync(path)
        path.chmod(0o444)
    manifest = Manifest(run=directory.name, created_utc=created_utc, files=digest(directory))
    draft = directory / f"{MANIFEST}.tmp"
    draft.write_text(json.dumps(manifest.model_dump(), indent=1) + "\n", encoding="utf-8")
    _sync(draft)
    draft.chmod(0o444)
    crash_point("before-manifest")
    draft.rename(directory / MANIFEST)
    _sync(directory)


def unseal(directory: Path) -> None:
    """Remove the manifest and give the write permission back, to go on with a run."""
    (directory / MANIFEST).unlink(missing_ok=True)
    (directory / f"{MANIFEST}.tmp").unlink(missing_ok=True)
    for path in directory.iterdir():
        path.chmod(path.stat().st_mode | stat.S_IWUSR)
    _sync(directory)


def read_manifest(directory: Path) -> Manifest | None:
    """Return the manifest, None when the run is not sealed.

    Raises:
        StorageError: the manifest is damaged.
    """
    path = directory / MANIFEST
    if not path.exists():
        return None
    try:
        return Manifest.model_validate_json(path.read_bytes())
    except ValidationError as error:
        raise StorageError(f"{path} is damaged: {error.errors()[0]['msg']}") from error


def _digest_file(path: Path) -> SealedFile:
    with path.open("rb") as file:
        return SealedFile(sha256=hashlib.file_digest(file, "sha256").hexdigest(), bytes=path.stat().st_size)


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
