"""Emulator of a length counter that speaks the catseye default profile."""
