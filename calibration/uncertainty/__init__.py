"""What results are good for: error budget, law of propagation, Monte Carlo, contributions."""
