"""Tests of the quantities of standards."""
