"""Quantities that standards define: positioning of rotary axes, robot performance, circular tests."""
