"""Radial error motion of J1 and J2."""
