"""The beam while measuring: finding it, settling, losing it and going on."""
