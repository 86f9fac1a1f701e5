"""Keeping the beam on a reflector while measuring: what was lost, and going on."""
