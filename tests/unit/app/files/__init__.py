"""Tests of the files that others may rely on."""
