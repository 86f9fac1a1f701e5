"""Tests of the serial arm of the bench."""
