"""Long runs with a make target of their own; the suite has a short form of each."""
