"""Emulator of a Heidenhain ND position display."""
