"""Tests of catseye."""
