"""Guided alignment of the beam: parallel to the XY plane, and through the J4 axis."""
