"""Screens of any serial arm."""
