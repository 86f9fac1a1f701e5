"""Tests of simulators/kuka."""
