"""Showing a page in the system's browser."""

import asyncio
import os
import shutil
import sys

_OPENERS = ("xdg-open", "open")


def can_open() -> bool:
    """Return whether there is a display, and a program that shows pages on it."""
    display = sys.platform == "darwin" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return display and _opener() is not None


async def open_page(uri: str) -> str:
    """Show a page; return why it is not shown, empty when it is."""
    opener = _opener()
    if opener is None:
        return "neither xdg-open nor open is installed"
    # A browser in the terminal would draw over the screen: it is given none.
    process = await asyncio.create_subprocess_exec(
        opener,
        uri,
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.DEVNULL,
        stderr=asyncio.subprocess.DEVNULL,
        start_new_session=True,
    )
    code = await process.wait()
    return f"{opener} ended with code {code}" if code else ""


def _opener() -> str | None:
    return next((found for name in _OPENERS if (found := shutil.which(name)) is not None), None)
