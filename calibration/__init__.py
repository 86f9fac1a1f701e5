"""Pure mathematics: kinematics, error maps, identification, uncertainty. No I/O, no clock."""
