"""An engine that ends without a word ends the command that detached it with a code of the table."""

import sys
from pathlib import Path

import pytest

from app.commands.engine import detach


@pytest.mark.parametrize(("script", "code"), [("exit 0", 70), ("exit 3", 3), ("kill -TERM $$", 143)])
def test_an_engine_that_says_nothing_has_an_exit_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str, code: int
) -> None:
    engine = tmp_path / "engine"
    engine.write_text(f"#!/bin/sh\ncat >/dev/null\n{script}\n")
    engine.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(engine))
    with pytest.raises(SystemExit) as ended:
        detach({"op": "start"}, tmp_path / "cell.toml", tmp_path, as_json=False)
    assert ended.value.code == code
