"""Calibration of robot arms with a laser interferometer: drivers, procedures, emulators, identification, programs."""
