"""Tests of simulators/melfa."""
