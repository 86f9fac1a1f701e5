"""Optimal design: which rows to measure."""
