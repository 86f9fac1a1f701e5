"""Tests of the cell file."""
