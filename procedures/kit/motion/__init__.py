"""Ways of the arm: stops with their directions of approach, tracking, checks between the stops, time."""
