"""What the results of one arm say over months."""
