"""Tests of walk-throughs."""
