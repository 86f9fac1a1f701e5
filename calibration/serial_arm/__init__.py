"""Calibration of a serial arm: which of its parameters, frames and compliances explain what an instrument saw."""
