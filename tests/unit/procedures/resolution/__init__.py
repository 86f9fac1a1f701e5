"""Tests of procedures that measure motion resolution."""
