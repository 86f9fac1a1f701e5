"""Emulated SpatialAnalyzer with its text interface T2SA."""
