"""attocube IDS3010 and successors."""
