"""Tests of simulators/world/scara."""
