"""Tests of the bench between runs and of what clients are told about it."""
