"""Showing a page: only where there is a display, by the system's own program."""

from pathlib import Path

import pytest

from catseye.app.tui.screens.working import can_open, open_page


@pytest.fixture
def opener(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An xdg-open that notes what it is given."""
    program = tmp_path / "xdg-open"
    program.write_text(f'#!/bin/sh\necho "$1" > {tmp_path}/seen\nexit $(cat {tmp_path}/code)\n')
    program.chmod(0o755)
    (tmp_path / "code").write_text("0")
    monkeypatch.setenv("PATH", f"{tmp_path}:/bin:/usr/bin")
    monkeypatch.setattr("sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    return tmp_path


@pytest.mark.usefixtures("opener")
def test_a_display_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not can_open()
    monkeypatch.setenv("WAYLAND_DISPLAY", "wayland-0")
    assert can_open()
    monkeypatch.setenv("PATH", "/nowhere")
    assert not can_open()


async def test_the_page_is_given_to_the_program(opener: Path) -> None:
    assert await open_page("file:///a/b.html") == ""
    assert (opener / "seen").read_text().strip() == "file:///a/b.html"
    (opener / "code").write_text("3")
    assert "xdg-open ended with code 3" in await open_page("file:///a/b.html")


async def test_without_a_program_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    assert "neither" in await open_page("file:///a/b.html")
