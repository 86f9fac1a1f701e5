"""Tests of simulators/vaisala."""
