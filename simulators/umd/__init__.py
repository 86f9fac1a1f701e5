"""Emulator of a uMD display."""
