"""What a robot, an interferometer, an air sensor or a tracker is to the rest of the program."""
