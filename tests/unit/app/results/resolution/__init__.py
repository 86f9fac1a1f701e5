"""Tests of results of motion resolution."""
