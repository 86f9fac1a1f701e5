"""Instruments that locate the arm independently of the interferometer."""
