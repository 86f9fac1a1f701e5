"""Tests of the emulated SpatialAnalyzer."""
