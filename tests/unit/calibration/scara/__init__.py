"""Tests of the SCARA model."""
