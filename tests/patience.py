"""How long a test waits for what is sure to come."""

from typing import Final

HANG_S: Final = 300.0
"""Whoever has waited so long waits for ever, on whatever machine; no test judges speed by it.

A test as a whole may take `timeout` of pyproject.toml.
"""
