"""Screens of motion resolution."""
