"""Figures of the report, one module each; a figure becomes SVG text that stands inside the page."""
