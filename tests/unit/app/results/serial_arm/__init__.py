"""Tests of results of serial arms."""
