"""Figures of motion resolution."""
