"""What a cell file has for serial arms with a tracker alone."""
