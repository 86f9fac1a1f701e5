"""Figures of a design."""
