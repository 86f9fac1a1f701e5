"""Tests of what the commands tell."""
