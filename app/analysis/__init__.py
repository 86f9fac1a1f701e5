"""What is done with distances and identified arms: identify, predict, validate, compensate, design, report."""
