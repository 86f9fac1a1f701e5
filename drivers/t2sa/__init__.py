"""Trackers behind the text interface T2SA of SpatialAnalyzer."""
