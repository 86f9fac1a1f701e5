"""An engine that ends without a word ends the command that detached it with a code of the table."""

import io
import json
import os
import sys
from pathlib import Path

import pytest

from catseye.app.cli.detached_engine import detach
from catseye.app.cli.engine import engine as engine_command
from catseye.app.protocol.requests import Resume, Start, encode_request


@pytest.mark.parametrize(("script", "code"), [("exit 0", 70), ("exit 3", 3), ("kill -TERM $$", 143)])
def test_an_engine_that_says_nothing_has_an_exit_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str, code: int
) -> None:
    engine = tmp_path / "engine"
    engine.write_text(f"#!/bin/sh\ncat >/dev/null\n{script}\n")
    engine.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(engine))
    with pytest.raises(SystemExit) as ended:
        detach(Start(procedure="script"), tmp_path / "cell.toml", tmp_path, as_json=False)
    assert ended.value.code == code


def test_a_fault_in_the_start_shows_where_when_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Faulty:
        def __init__(self, *_: object) -> None:
            pass

        async def run_once(self, *_: object) -> None:
            raise ZeroDivisionError("a fault of the program")

    monkeypatch.setattr("catseye.app.cli.detached_engine.EngineProcess", Faulty)
    monkeypatch.setattr(os, "setsid", lambda: None)
    for debug, expected in (("", "set CATSEYE_DEBUG=1 and repeat"), ("1", "in run_once")):
        monkeypatch.setenv("CATSEYE_DEBUG", debug)
        asked = encode_request(1, Resume(run="last"))
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(asked)))
        with pytest.raises(SystemExit) as ended:
            engine_command(tmp_path / "cell.toml", once=True, runs=tmp_path)
        assert ended.value.code == 70
        assert expected in json.loads(capsys.readouterr().out)["error"]
