"""A store in which bits have flipped is read or refused by name, never with a fault of the program."""

import random
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from catseye.app.cli.export import export as export_command
from catseye.app.cli.show import show as show_command
from catseye.app.cli.verify import verify as verify_command
from catseye.app.errors import StorageError
from catseye.app.exitcode import ExitCode
from catseye.app.results.scara.distances import load_distances
from catseye.app.store.seal import MANIFEST, read_manifest, unseal
from tests.unit.app.test_path_comparison import measured, stored

FLIPS = 60
SEED = 14
HEADER_BYTES = 100


async def sealed(folder: Path) -> Path:
    return (await stored(folder, "open-loop", measured()[:12])).path


async def unsealed(folder: Path) -> Path:
    path = await sealed(folder)
    unseal(path)
    return path


def show(run: Path) -> None:
    show_command(str(run), as_json=False)
    show_command(str(run), as_json=True)


def verify(run: Path) -> None:
    verify_command(str(run), as_json=False)


def export(run: Path) -> None:
    export_command(str(run), run.parent / "points.csv", None, None)


def identify(run: Path) -> None:
    load_distances([str(run)], None, None, None)


def show_unverified(run: Path) -> None:
    show_command(str(run), as_json=True, unverified=True)


def export_unverified(run: Path) -> None:
    export_command(str(run), run.parent / "points.json", None, None, unverified=True)


def identify_unverified(run: Path) -> None:
    load_distances([str(run)], None, None, None, unverified=True)


COMMANDS: tuple[Callable[[Path], None], ...] = (show, verify, export, identify)
UNVERIFIED: tuple[Callable[[Path], None], ...] = (show_unverified, export_unverified, identify_unverified)


def refused(run: Path, command: Callable[[Path], None]) -> bool:
    """Do what the command does; return whether it refused the run as a storage fault."""
    caught: list[StorageError] = []
    try:
        command(run)
    except StorageError as error:
        caught.append(error)
    assert all(error.exit_code is ExitCode.STORAGE and run.name in str(error) for error in caught)
    return bool(caught)


def flipped(data: bytes, position: int, bit: int) -> bytes:
    changed = bytearray(data)
    changed[position] ^= 1 << bit
    return bytes(changed)


def write(path: Path, data: bytes) -> None:
    path.chmod(0o644)
    path.write_bytes(data)


def some_bits(data: bytes) -> list[tuple[int, int]]:
    """Return bits of the header, of text and of anything else; a page of zeros says little."""
    chosen = random.Random(SEED)
    used = [at for at, byte in enumerate(data) if byte]
    places = [*chosen.sample(range(HEADER_BYTES), FLIPS // 6), *chosen.sample(used, FLIPS)]
    return [(place, chosen.randrange(8)) for place in places]


def with_flips(database: Path) -> Iterator[tuple[int, int]]:
    """Yield where a bit is flipped, while it is."""
    data = database.read_bytes()
    for position, bit in some_bits(data):
        write(database, flipped(data, position, bit))
        yield position, bit


async def test_each_flip_in_a_sealed_database_is_refused(tmp_path: Path) -> None:
    run = await sealed(tmp_path)
    for position, bit in with_flips(run / "run.sqlite"):
        for command in COMMANDS:
            assert refused(run, command), (command.__name__, position, bit)


async def test_flips_in_an_unsealed_database_are_read_or_refused(tmp_path: Path) -> None:
    run = await unsealed(tmp_path)
    for _ in with_flips(run / "run.sqlite"):
        for command in COMMANDS:
            refused(run, command)


async def test_flipped_values_in_an_unsealed_run_are_refused(tmp_path: Path) -> None:
    run = await unsealed(tmp_path)
    data = (run / "run.sqlite").read_bytes()
    for text in (b"rows", b"run-ended", b'"link1_mm"', b'"cell file"', b"P1"):
        write(run / "run.sqlite", flipped(data, data.index(text) + 1, 0))
        assert refused(run, show), text


async def test_flips_in_a_run_taken_unverified_are_read_or_refused(tmp_path: Path) -> None:
    run = await sealed(tmp_path)
    for _ in with_flips(run / "run.sqlite"):
        for command in UNVERIFIED:
            refused(run, command)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.01, 0.3, 0.5, 0.9, 0.999])
async def test_a_truncated_database_is_refused(tmp_path: Path, share: float) -> None:
    for run in (await sealed(tmp_path / "sealed"), await unsealed(tmp_path / "unsealed")):
        data = (run / "run.sqlite").read_bytes()
        write(run / "run.sqlite", data[: int(share * len(data))])
        for command in COMMANDS:
            assert refused(run, command), (command.__name__, run.parent.name)


async def test_flips_in_a_manifest_are_read_or_refused(tmp_path: Path) -> None:
    run = await sealed(tmp_path)
    data = (run / MANIFEST).read_bytes()
    chosen = random.Random(SEED)
    for position in chosen.sample(range(len(data)), FLIPS):
        write(run / MANIFEST, flipped(data, position, chosen.randrange(8)))
        for command in COMMANDS:
            refused(run, command)


async def test_what_is_restored_is_taken_again(tmp_path: Path) -> None:
    run = await sealed(tmp_path)
    shutil.copy(run / "run.sqlite", tmp_path / "copy")
    write(run / "run.sqlite", b"nothing")
    assert refused(run, show)
    write(run / "run.sqlite", (tmp_path / "copy").read_bytes())
    assert read_manifest(run) is not None
    assert not refused(run, show)
