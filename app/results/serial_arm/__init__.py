"""Calibration of serial arms from stored or imported measurements: results, what is said of them, files."""
