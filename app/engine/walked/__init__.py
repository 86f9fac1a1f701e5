"""Where an arm was walked, and the rule that a real one drives nowhere else."""
