"""Tests of what runs say about themselves."""
