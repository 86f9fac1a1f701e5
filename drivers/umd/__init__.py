"""uMD1 and uMD2 open displays."""
