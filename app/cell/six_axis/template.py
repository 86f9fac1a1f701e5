"""The cell file of a serial arm that is calibrated by a tracker, as `catseye init --system six-axis` writes it."""

from collections.abc import Mapping
from importlib.resources import files
from types import MappingProxyType
from typing import Final

from catseye.app.cell.unattended_template import UNATTENDED

_IRB120: Final = (files("catseye.app.cell.six_axis") / "irb120.toml").read_text(encoding="utf-8")

BY_ARM: Final[Mapping[str, str]] = MappingProxyType({"irb120": f"{_IRB120}\n{UNATTENDED}"})
"""Texts by arm; the first is the one that is meant where none is named."""
