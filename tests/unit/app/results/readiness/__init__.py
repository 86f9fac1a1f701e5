"""Tests of what a cell is ready for."""
