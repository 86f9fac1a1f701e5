"""What a cell file has for motion resolution alone."""
