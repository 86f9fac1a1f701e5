"""Motion resolution: steps in recordings, their errors, least increment steps, joint models, Cartesian prediction."""
