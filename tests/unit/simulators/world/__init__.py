"""Tests of simulators/world."""
