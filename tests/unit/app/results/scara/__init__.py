"""Tests of the analyses of a SCARA."""
