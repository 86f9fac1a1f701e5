"""Faults that are put into critical code one at a time, to show that the tests catch them."""
