"""Profiles that come with the program."""
