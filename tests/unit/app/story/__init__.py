"""Tests of the story of a run."""
