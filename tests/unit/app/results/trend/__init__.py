"""Trends of results over months."""
