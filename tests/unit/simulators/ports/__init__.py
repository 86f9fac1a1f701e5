"""Tests of simulators/ports."""
