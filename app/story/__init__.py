"""The story of a run: what happened, in readable order."""
