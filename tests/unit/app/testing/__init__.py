"""Tests of what driver developers elsewhere get."""
