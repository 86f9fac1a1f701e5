"""Jobs of a campaign."""
