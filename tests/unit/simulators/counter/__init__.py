"""Tests of simulators/counter."""
