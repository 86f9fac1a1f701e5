"""Tests of watching a bench."""
