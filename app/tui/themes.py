"""Colours: a dark and a light theme, and one of high contrast."""

from typing import Final

from textual.theme import Theme

HIGH_CONTRAST: Final = Theme(
    name="catseye-high-contrast",
    primary="#00ffff",
    secondary="#ffff00",
    accent="#ffff00",
    foreground="#ffffff",
    background="#000000",
    surface="#000000",
    panel="#1a1a1a",
    success="#00ff00",
    warning="#ffff00",
    error="#ff5555",
    dark=True,
)

DARK: Final = Theme(
    name="catseye-dark",
    primary="#5fafd7",
    secondary="#8787af",
    accent="#d7af5f",
    foreground="#d0d0d0",
    background="#121417",
    surface="#1b1f24",
    panel="#252b32",
    success="#5faf5f",
    warning="#d7875f",
    error="#d75f5f",
    dark=True,
)

LIGHT: Final = Theme(
    name="catseye-light",
    primary="#005f87",
    secondary="#5f5f87",
    accent="#875f00",
    foreground="#1c1c1c",
    background="#f4f4f0",
    surface="#ffffff",
    panel="#e4e4de",
    success="#00660a",
    warning="#9a4a00",
    error="#a00000",
    dark=False,
)

THEMES: Final = (DARK, LIGHT, HIGH_CONTRAST)
