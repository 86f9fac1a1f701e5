"""A disk that fails under a program: the library beside this file is preloaded into it."""

import errno
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Final

CALLS: Final = ("write", "sync", "make", "name", "all")
"""Kinds of calls: writing, flushing, making files and folders, renaming and changing modes, each of them."""

FAULTS: Final = {
    "full": errno.ENOSPC,
    "broken": errno.EIO,
    "read-only": errno.EROFS,
    "over quota": errno.EDQUOT,
}


@dataclass(frozen=True)
class FailingDisk:
    """A disk that fails from one call on.

    Attributes:
        library: the compiled one.
        folder: below which it fails.
        mark: gets the name of the first call that failed.
    """

    library: Path
    folder: Path
    mark: Path

    @classmethod
    def built(cls, work: Path, folder: Path) -> "FailingDisk":
        """Compile it.

        Args:
            work: where library and mark are.
            folder: below which it fails.
        """
        library = work / "failing_disk.so"
        source = Path(__file__).with_suffix(".c")
        subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)
        return cls(library, folder.resolve(), work / "struck")

    def order(self, fault: str, calls: str, number: int, part: int = 0) -> dict[str, str]:
        """Return the environment of a program whose disk fails.

        Args:
            fault: one of FAULTS.
            calls: one of CALLS.
            number: which of these calls is the first to fail, from 1.
            part: how many bytes the first write takes all the same.
        """
        self.mark.unlink(missing_ok=True)
        text = f"{self.folder}|{calls}|{number}|{FAULTS[fault]}|{part}|{self.mark}"
        return {"LD_PRELOAD": str(self.library), "CATSEYE_TEST_DISK": text}

    @property
    def struck(self) -> str:
        """The first call that failed, with its path; empty when none did."""
        return self.mark.read_text("utf-8").strip() if self.mark.exists() else ""
