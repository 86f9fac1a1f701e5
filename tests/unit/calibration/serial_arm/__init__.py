"""Tests of the calibration of serial arms."""
