"""Emulator of a Lasertex HPI-3D."""
