"""Tests of shared work."""
