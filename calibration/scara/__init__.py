"""Distances of a SCARA and its error maps: the first model on `calibration.core`."""
