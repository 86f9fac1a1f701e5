"""Tests of what analyses say."""
