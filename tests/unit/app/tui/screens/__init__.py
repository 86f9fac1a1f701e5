"""Tests of the main screens."""
