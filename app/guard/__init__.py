"""The process that says STOP when the engine dies or stalls, and the lock that gives an arm one owner."""
