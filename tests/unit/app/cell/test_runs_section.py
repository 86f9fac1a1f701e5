"""[runs] says which rights new runs have."""

import pytest
from pydantic import ValidationError

from catseye.app.cell.model import StoredRuns


@pytest.mark.parametrize(("mode", "umask"), [("0750", 0o027), ("700", 0o077), ("0777", 0), ("", None)])
def test_a_mode_is_what_the_umask_leaves(mode: str, umask: int | None) -> None:
    assert StoredRuns(mode=mode).umask == umask


@pytest.mark.parametrize("mode", ["rwx", "0o750", "0780", "75"])
def test_no_octal_number_is_no_mode(mode: str) -> None:
    with pytest.raises(ValidationError):
        StoredRuns(mode=mode)
