"""Motion by set points, one in every cycle of the controller (MXT)."""
