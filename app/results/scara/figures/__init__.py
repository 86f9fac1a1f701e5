"""Figures of an identified SCARA."""
