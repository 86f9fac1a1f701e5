"""What a driver has to do, check by check."""
