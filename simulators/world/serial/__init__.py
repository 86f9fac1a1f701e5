"""A serial arm with its drives: what a controller commands, and what the arm does of it."""
