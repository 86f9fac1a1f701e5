"""Tests of the algebra of rows and parameters."""
