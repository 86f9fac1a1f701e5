"""Reflector search: where the reflectors stand, and the beam's zero direction."""
