"""Repeatability at chosen poses."""
