"""Tests of identification from scans."""
