"""Tests of what was walked."""
