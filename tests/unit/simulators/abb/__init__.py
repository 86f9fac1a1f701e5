"""Tests of simulators/abb."""
