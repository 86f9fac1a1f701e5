"""Mitsubishi MELFA controllers over the R-protocol."""
