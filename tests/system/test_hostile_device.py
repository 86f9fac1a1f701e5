"""An instrument whose name is full of escape sequences commands neither terminal nor screen nor log."""

import re
from pathlib import Path

import pytest

from tests.system.command import catseye, emulated, last_run, only
from tests.system.hostile_bench import NAME, TITLE
from tests.system.screen import on_screen

EDIT = {'driver = "line-counter"\n': 'driver = "attocube-ids"\n', 'profile = "default"\n': ""}
SPEED = "50"
RAW = [NAME.encode(), *(sign.encode() for sign in "\x9b\u202e\u2066\x00\x07"), b"\x1b]0;" + TITLE.encode()]


def harmless(raw: bytes) -> bool:
    return not any(part in raw for part in RAW)


def plain(text: str) -> bool:
    """Return whether lines hold nothing but what can be printed."""
    return all(line.isprintable() for line in text.split("\n"))


@pytest.mark.slow
def test_no_command_carries_the_name_raw(tmp_path: Path) -> None:
    with emulated(
        tmp_path, "--speed", SPEED, edit=EDIT | only("P2"), module="tests.system.hostile_bench"
    ) as bench:
        looked = catseye("doctor", bench.cell, cwd=tmp_path)
        run = catseye(
            "run", "reflector-search", "--cell", bench.cell, "--speed", SPEED, "--json", cwd=tmp_path
        )
    assert run.returncode == 0, run.stderr
    assert rf"EMULATOR\x1b]0;{TITLE}" in looked.stdout
    name = last_run(tmp_path, "reflector-search")
    shown = [catseye("show", name, *options, cwd=tmp_path) for options in ((), ("--json",))]
    page = tmp_path / "page.html"
    catseye("report", name, "-o", page, cwd=tmp_path)
    for said in (looked, run, *shown):
        assert plain(said.stdout)
        assert plain(said.stderr)
    log = next(tmp_path.rglob("app.log")).read_text(encoding="utf-8")
    assert plain(log)
    assert harmless(page.read_bytes())


@pytest.mark.slow
def test_no_screen_carries_the_name_raw(tmp_path: Path) -> None:
    with (
        emulated(tmp_path, "--speed", SPEED, edit=EDIT, module="tests.system.hostile_bench") as bench,
        on_screen("tui", "--cell", bench.cell, cwd=tmp_path, size=(160, 50)) as screen,
    ):
        screen.shows(rf"EMULATOR\x1b]0;{TITLE}")
        # The interface itself sets the shape of the pointer.
        received = re.sub(rb"\x1b\]22;[a-z]+\x07", b"", screen.received)
        assert [part for part in RAW if part in received] == []
