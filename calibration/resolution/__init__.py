"""Motion resolution: steps of a joint or of the tool in a recording, least increment step, lost motion."""
