"""One owner per arm: who gets the lock, who is named, and what a hostile file can do."""

import errno
import fcntl
import os
import stat
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from catseye.app.errors import ArmInUseError, exit_code_of
from catseye.app.exitcode import ExitCode
from catseye.app.guard import lock
from catseye.app.guard.lock import Owner, OwnerLock, arms_behind

ARM = "192.168.0.20"
ANNA = Owner("12", "anna", "catseye run", "run 20260101T120000Z_open-loop_a1", "2026-01-01T12:00:00+00:00")
BEN = Owner("13", "ben", "catseye engine", "moved by hand", "2026-01-01T12:05:00+00:00")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    tmp_path.chmod(0o1777)
    monkeypatch.setattr(lock, "_FOLDERS", (tmp_path,))
    return tmp_path


def taken(owner: Owner = ANNA, arm: str = ARM) -> OwnerLock:
    return OwnerLock((arm,), owner)


def refusal(owner: Owner = BEN) -> ArmInUseError:
    with pytest.raises(ArmInUseError) as refused:
        taken(owner)
    return refused.value


def test_second_owner_is_refused_with_the_firsts_name() -> None:
    first = taken()
    error = refusal()
    for part in ("12", "anna", "catseye run", "20260101T120000Z_open-loop_a1", "2026-01-01T12:00:00"):
        assert part in str(error)
    assert exit_code_of(error) == ExitCode.DEVICE
    first.release()
    taken(BEN).release()


def as_another_user(folder: Path) -> str:
    """Take the lock from another process, of another user where this one may become one; return what it says."""
    words = [sys.executable, "-m", "tests.unit.app.guard.other_user", str(folder), ARM]
    said = subprocess.run(words, capture_output=True, text=True, timeout=60, check=True)
    return said.stdout.strip()


def test_another_user_is_refused_too_and_may_follow(monkeypatch: pytest.MonkeyPatch) -> None:
    # The folder of a test is closed to others.
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o1777)
        monkeypatch.setattr(lock, "_FOLDERS", (folder,))
        first = taken()
        assert "process 12 (catseye run) of user anna" in as_another_user(folder)
        first.release(keep=True)
        assert as_another_user(folder) == f"owns {ARM}"
        # It may not remove a file of ours there, and leaves it empty.
        taken(BEN).release()


def test_a_full_folder_keeps_nobody_from_owning(monkeypatch: pytest.MonkeyPatch) -> None:
    def is_full(*_: object) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "pwrite", is_full)
    first = taken()
    assert "has not said its name" in str(refusal())
    first.release()


def test_a_folder_that_locks_nothing_owns_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def locks_nothing(*_: object) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", locks_nothing)
    assert "cannot be locked" in str(refusal())


def test_another_arm_has_a_lock_of_its_own() -> None:
    first, second = taken(), taken(BEN, "192.168.0.21")
    first.release()
    with pytest.raises(ArmInUseError, match="ben"):
        taken(ANNA, "192.168.0.21")
    second.release()
    taken(ANNA, "192.168.0.21").release()


def test_a_duplicate_keeps_the_arm_owned(folder: Path) -> None:
    first = taken()
    duplicate = os.dup(first.descriptors[0])
    first.release(keep=True)
    assert "anna" in str(refusal())
    os.close(duplicate)
    taken(BEN).release()
    assert list(folder.iterdir()) == []


def test_what_a_guard_left_reaches_the_next_owner() -> None:
    first = taken()
    path = lock.lock_path(ARM)
    with path.open("a", encoding="ascii") as file:
        file.write("stopped=2026-01-01T12:01:00Z the program died\n")
    first.release(keep=True)
    second = taken(BEN)
    assert len(second.history) == 1
    assert "the program died" in second.history[0]
    assert "anna" in second.history[0]
    second.release()
    third = taken()
    assert third.history == []
    third.release()


def test_an_unreleased_arm_is_reported_to_the_next_owner() -> None:
    """Program and guard were killed together: neither has left word."""
    taken().release(keep=True)
    second = taken(BEN)
    (history,) = second.history
    assert "was not given back" in history
    assert "anna" in history
    second.release()


def test_an_owner_that_gives_up_leaves_what_it_found() -> None:
    first = taken()
    first.note("the program died")
    first.release(keep=True)
    taken(BEN).undo()
    third = taken()
    assert "the program died" in third.history[0]
    assert "anna" in third.history[0]
    third.release()


def test_a_second_address_in_use_leaves_the_first_free() -> None:
    holder = taken(arm="192.168.0.21")
    with pytest.raises(ArmInUseError):
        OwnerLock((ARM, "192.168.0.21"), BEN)
    alone = taken()
    assert alone.history == []
    alone.release()
    holder.release()


def test_every_user_may_open_the_file() -> None:
    first = taken()
    assert stat.S_IMODE(lock.lock_path(ARM).stat().st_mode) == 0o666
    first.release()


@pytest.mark.parametrize("kind", ["link", "folder", "fifo", "hard link"])
def test_a_file_that_is_none_is_refused_untouched(kind: str, folder: Path) -> None:
    path, other = lock.lock_path(ARM), folder / "other"
    other.write_text("precious", encoding="ascii")
    match kind:
        case "link":
            path.symlink_to(other)
        case "folder":
            path.mkdir()
        case "fifo":
            os.mkfifo(path)
        case _:
            path.hardlink_to(other)
    error = refusal()
    assert str(path) in str(error)
    assert other.read_text(encoding="ascii") == "precious"


def test_bytes_that_somebody_wrote_reach_no_terminal() -> None:
    first = taken()
    with lock.lock_path(ARM).open("r+b") as file:
        file.write(b"pid=1\nuser=\x1b[2Jroot\nprogram=p\nrun=" + b"r" * 9000 + b"\nsince=s\n")
    text = str(refusal())
    assert "\x1b" not in text
    assert len(text) < 1000
    first.release()


def test_a_file_removed_between_opening_and_locking_counts_for_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    path, opened = lock.lock_path(ARM), lock._opened  # noqa: SLF001  # the moment between two calls
    first = taken()
    looks: list[int] = []

    def open_and_lose(given: Path) -> int:
        descriptor = opened(given)
        if not looks:
            first.release()
        looks.append(descriptor)
        return descriptor

    monkeypatch.setattr(lock, "_opened", open_and_lose)
    second = taken(BEN)
    assert len(looks) == 2
    assert os.path.samestat(path.stat(), os.fstat(second.descriptors[0]))
    second.release()


@pytest.mark.parametrize(
    ("endpoint", "arms"),
    [
        ("tcp://192.168.0.20:10001", ("192.168.0.20",)),
        ("tcp://192.168.0.20:10002", ("192.168.0.20",)),
        ("tcp://127.0.0.1:10001", ("loopback:10001",)),
        ("tcp://[::1]:10001", ("loopback:10001",)),
        ("tcp://[::ffff:127.0.0.1]:10001", ("loopback:10001",)),
        ("tcp://localhost:10001", ("loopback:10001",)),
        ("serial:///dev/../dev/null?baud=9600", ("/dev/null",)),
    ],
)
async def test_controllers_are_known_by_their_address(endpoint: str, arms: tuple[str, ...]) -> None:
    assert await arms_behind(endpoint) == arms
