"""Figures of a SCARA."""
