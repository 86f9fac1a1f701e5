"""Texts for the clipboard of the terminal (OSC 52)."""

from typing import Any, Final

from textual.app import App

_TOLD: Final = 200
"""Letters of what was copied that are said."""


def copy(app: App[Any], text: str) -> None:
    """Copy a text, and say which."""
    app.copy_to_clipboard(text)
    told = text.expandtabs(2)
    shown = told if len(told) <= _TOLD else f"{told[:_TOLD]} …"
    app.notify(shown, title="copied", markup=False)
