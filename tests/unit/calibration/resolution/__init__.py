"""Tests of the evaluation of steps."""
