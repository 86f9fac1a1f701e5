"""Continuous scans: millions of distances, solved block by block with constant memory."""
