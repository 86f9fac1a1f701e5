"""Emulator of an attocube IDS3010."""
