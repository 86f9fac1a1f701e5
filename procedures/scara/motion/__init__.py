"""Motions that keep the beam on a reflector."""
