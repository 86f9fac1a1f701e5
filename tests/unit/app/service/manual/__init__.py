"""Tests of motion by hand between runs."""
