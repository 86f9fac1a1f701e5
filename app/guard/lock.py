"""One owner per arm: a lock that every program and every user of this machine sees, released by the kernel."""

import asyncio
import contextlib
import fcntl
import getpass
import ipaddress
import os
import re
import socket
import stat
import sys
from dataclasses import asdict, dataclass, fields
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Final, Self

from catseye.app.errors import ArmInUseError
from catseye.drivers.links.endpoint import SerialEndpoint, parse_endpoint
from catseye.drivers.roles.errors import LinkError

_FOLDERS: Final = (Path("/run/lock"), Path("/tmp"))
_SHARED = stat.S_ISVTX | stat.S_IWOTH
_MOST_BYTES = 8192
_LOOKS = 100
_WAITS = 20
_WAIT_S = 0.1
_LONGEST_VALUE = 160
_STOPPED = "stopped"
_UNSEEMLY = re.compile(r"[^ -~]")
_NO_NAME = re.compile(r"[^A-Za-z0-9.]+")


@dataclass(frozen=True)
class Owner:
    """Who moves an arm.

    Attributes:
        pid: process.
        user: name of the user.
        program: command.
        run: name of the run, or what else moves the arm.
        since: UTC, ISO 8601.
    """

    pid: str
    user: str
    program: str
    run: str
    since: str

    @classmethod
    def here(cls, run: str) -> Self:
        """Return this process as the owner."""
        program = " ".join(["catseye", *sys.argv[1:2]])
        since = datetime.now(UTC).isoformat(timespec="seconds")
        return cls(str(os.getpid()), getpass.getuser(), program, run, since)

    @property
    def text(self) -> str:
        """One clause that names the owner."""
        return f"process {self.pid} ({self.program}) of user {self.user}, {self.run}, since {self.since}"


class OwnerLock:
    """The right to move one arm; descriptors may be shared with a process that has to outlive this one.

    Attributes:
        arm: what is locked: the controller's address, on loopback with its port, or the device of a serial line.
        history: what has become of this arm since it was given back last, for the operator: how it was stopped, or
            that neither its owner nor the guard has said so.
    """

    def __init__(self, arms: tuple[str, ...], owner: Owner) -> None:
        """Take the lock.

        Raises:
            ArmInUseError: another program has it, or there is no place for it; the text names the holder.
        """
        self.arm = arms[0]
        self.descriptors: list[int] = []
        self._paths: list[Path] = []
        self._found: list[bytes] = []
        self.history: list[str] = []
        try:
            for arm in arms:
                self._take(arm, owner)
        except BaseException:
            self.undo()
            raise

    @classmethod
    async def taken(cls, endpoint: str, owner: Owner) -> Self:
        """Take the lock of the controller behind an endpoint; see there.

        The guard of a program that has just died holds it until its STOP is done: that is waited for.
        """
        arms = await arms_behind(endpoint)
        for _ in range(_WAITS):
            try:
                return cls(arms, owner)
            except ArmInUseError:
                await asyncio.sleep(_WAIT_S)
        return cls(arms, owner)

    def note(self, text: str) -> None:
        """Leave word of a stop for whoever takes the arm next, as its guard does."""
        line = f"{_STOPPED}={datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ} {text}\n".encode()
        for descriptor in self.descriptors:
            with contextlib.suppress(OSError):
                os.pwrite(descriptor, line, os.fstat(descriptor).st_size)

    def undo(self) -> None:
        """Give the right back as if it had never been taken: what was left for its owner is left for the next one."""
        for descriptor, found in zip(self.descriptors, self._found, strict=True):
            with contextlib.suppress(OSError):
                os.ftruncate(descriptor, 0)
                os.pwrite(descriptor, found, 0)
        self.release(keep=True)

    def release(self, *, keep: bool = False) -> None:
        """Give the right back; may be called any number of times.

        Args:
            keep: what a guard has left is for the next owner too.
        """
        if not keep:
            for path, descriptor in zip(self._paths, self.descriptors, strict=True):
                os.ftruncate(descriptor, 0)
                # The file of another user stays.
                with contextlib.suppress(OSError):
                    path.unlink()
        self._close()

    def _take(self, arm: str, owner: Owner) -> None:
        path = lock_path(arm)
        descriptor = _locked(arm, path)
        self._paths.append(path)
        self.descriptors.append(descriptor)
        self._found.append(os.pread(descriptor, _MOST_BYTES, 0))
        self.history += _history(_lines(self._found[-1]))
        # Who owns it is for texts only: the arm is owned also where the folder is full.
        with contextlib.suppress(OSError):
            os.ftruncate(descriptor, 0)
            os.pwrite(descriptor, "".join(f"{k}={v}\n" for k, v in asdict(owner).items()).encode(), 0)

    def _close(self) -> None:
        self._paths.clear()
        self._found.clear()
        while self.descriptors:
            os.close(self.descriptors.pop())


async def arms_behind(endpoint: str) -> tuple[str, ...]:
    """Return the names under which the controller behind an endpoint is locked.

    Raises:
        LinkError: the host's name cannot be resolved.
    """
    place = parse_endpoint(endpoint)
    if isinstance(place, SerialEndpoint):
        return (_real(place.device),)
    try:
        found = await asyncio.get_running_loop().getaddrinfo(place.host, place.port, type=socket.SOCK_STREAM)
    except OSError as error:
        raise LinkError(f"{endpoint}: its name cannot be resolved ({error}): check the endpoint") from error
    return tuple(sorted({_arm(str(address[0]), place.port) for _, _, _, _, address in found}))


def _real(device: str) -> str:
    return os.path.realpath(device)


def lock_path(arm: str) -> Path:
    """Return the file of an arm's lock; the same for every user of this machine."""
    folder = next(folder for folder in _FOLDERS if _is_shared(folder) or folder == _FOLDERS[-1])
    digest = sha256(arm.encode()).hexdigest()[:12]
    return folder / f"catseye-arm-{_NO_NAME.sub('-', arm).strip('-')[:48]}-{digest}.lock"


def _is_shared(folder: Path) -> bool:
    """Return whether everybody may make files there and nobody may remove another's; the same for every user."""
    try:
        found = folder.lstat()
    except OSError:
        return False
    return stat.S_ISDIR(found.st_mode) and found.st_mode & _SHARED == _SHARED


def _arm(address: str, port: int) -> str:
    host = ipaddress.ip_address(address.partition("%")[0])
    host = getattr(host, "ipv4_mapped", None) or host
    # Every emulated arm of this machine has the same host; localhost has an address of each kind.
    return f"loopback:{port}" if host.is_loopback else str(host)


def _locked(arm: str, path: Path) -> int:
    """Open the lock's file and lock it.

    Raises:
        ArmInUseError: another program holds it, or it cannot be opened.
    """
    for _ in range(_LOOKS):
        descriptor = _opened(path)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_at(path, descriptor):
                return descriptor
        except BlockingIOError:
            with os.fdopen(descriptor):
                raise _in_use(arm, _owner(_lines(os.pread(descriptor, _MOST_BYTES, 0)))) from None
        except OSError as error:
            os.close(descriptor)
            raise ArmInUseError(
                f"{path}: the arm cannot be locked ({error.strerror}): nothing was sent to it; check that folder"
            ) from error
        # Its last owner has removed it between our opening and locking it.
        os.close(descriptor)
    raise ArmInUseError(
        f"{path}: the lock of the arm at {arm} comes and goes: find out which programs move it"
    )


def _in_use(arm: str, holder: Owner | None) -> ArmInUseError:
    by = holder.text if holder else "another program that has not said its name yet"
    return ArmInUseError(
        f"the arm at {arm} is in use by {by}: nothing was sent to it; end that first, or wait for its end"
    )


def _is_at(path: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(path.lstat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False


def _opened(path: Path) -> int:
    """Open the lock's file, made when missing; nothing that it leads to, or that is no plain file, is touched.

    Raises:
        ArmInUseError: it cannot be opened.
    """
    flags = os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC | os.O_NONBLOCK
    try:
        try:
            # The kernel may refuse O_CREAT for another user's file in such a folder.
            descriptor = os.open(path, flags)
        except FileNotFoundError:
            descriptor = _made(path, flags)
    except OSError as error:
        raise ArmInUseError(
            f"{path}: the lock of the arm cannot be opened ({error.strerror}): nothing was sent to the arm; find out "
            "who made it so, then remove it while no program moves the arm"
        ) from error
    found = os.fstat(descriptor)
    if not stat.S_ISREG(found.st_mode) or found.st_nlink > 1:
        os.close(descriptor)
        raise ArmInUseError(
            f"{path} is no plain file of its own: nothing was sent to the arm; find out who made it, then remove it"
        )
    return descriptor


def _made(path: Path, flags: int) -> int:
    try:
        descriptor = os.open(path, flags | os.O_CREAT | os.O_EXCL, 0o666)
    except FileExistsError:
        return os.open(path, flags)
    os.fchmod(descriptor, 0o666)
    return descriptor


def _lines(written: bytes) -> list[tuple[str, str]]:
    """Return what the file says, made harmless: anybody may have written it."""
    text = written.decode("ascii", "replace")
    pairs = (line.partition("=") for line in text.splitlines())
    return [(key, _UNSEEMLY.sub("?", value)[:_LONGEST_VALUE]) for key, _, value in pairs]


def _history(lines: list[tuple[str, str]]) -> list[str]:
    who = _owner(lines)
    then = f" (then: {who.text})" if who else ""
    stops = [f"this arm was stopped before: {text}{then}" for key, text in lines if key == _STOPPED]
    if stops or who is None:
        return stops
    # A guard that outlives its program leaves word.
    return [
        f"this arm was not given back: {who.text} ended without that, and its guard with it, so perhaps nobody has "
        "stopped it: look at it before it moves"
    ]


def _owner(lines: list[tuple[str, str]]) -> Owner | None:
    said = dict(lines)
    names = [field.name for field in fields(Owner)]
    return Owner(**{name: said[name] for name in names}) if said.keys() >= set(names) else None
