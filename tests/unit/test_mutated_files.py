"""Files of any kind with changes in them are read, or refused by a sentence that names the file; never anything else.

`make campaign-fuzz` tries thousands of each kind.
"""

import json
import random
import resource
from pathlib import Path

import pytest

from catseye.app.errors import exit_code_of
from catseye.app.exitcode import ExitCode
from tests.fuzz.amount import FILES, source, tell
from tests.fuzz.files import KINDS, Kind
from tests.fuzz.mutation import mutated, mutated_document

LONGEST_TEXT = 20_000
MOST_GROWTH_KB = 300_000


def changed(kind: Kind, valid: bytes, numbers: random.Random) -> bytes:
    """Return the bytes of a changed file: half of the documents have other values, which bytes hardly ever give."""
    if kind.loads is not None and numbers.random() < 0.5:
        return kind.dumped(mutated_document(kind.loads(valid), numbers))
    return mutated(valid, numbers, [valid])


def refused(kind: Kind, path: Path) -> str:
    """Read a file; return the sentence that refuses it, empty where it is taken."""
    try:
        kind.read(path)
    except Exception as error:
        if exit_code_of(error) in {ExitCode.FAULT, ExitCode.INTERRUPTED, ExitCode.TERMINATED}:
            raise
        return str(error)
    return ""


def resident_kb() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


@pytest.mark.parametrize("name", KINDS)
def test_a_valid_file_is_read(name: str, tmp_path: Path) -> None:
    kind = KINDS[name]
    path = tmp_path / kind.name
    path.write_bytes(kind.make(tmp_path))
    assert refused(kind, path) == ""


@pytest.mark.parametrize("name", KINDS)
def test_a_changed_file_is_read_or_refused_by_name(name: str, tmp_path: Path) -> None:
    kind, numbers = KINDS[name], source(name)
    path = tmp_path / kind.name
    valid = kind.make(tmp_path)
    before_kb, refusals = resident_kb(), 0
    for _ in range(FILES):
        path.write_bytes(changed(kind, valid, numbers))
        text = refused(kind, path)
        if text:
            refusals += 1
            # A draft is of a file that the wizard shows above it.
            assert path.stem in text or "this file" in text, text
            assert len(text) < LONGEST_TEXT
    assert resident_kb() - before_kb < MOST_GROWTH_KB
    tell(f"{name}: {FILES} changed files, {refusals} refused; {json.dumps(resident_kb() - before_kb)} kB")
