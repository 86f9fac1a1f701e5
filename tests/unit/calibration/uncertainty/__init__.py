"""Tests of budget, law of propagation and Monte Carlo."""
