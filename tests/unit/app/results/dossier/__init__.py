"""Tests of the page that joins the day of a cell."""
