"""What the kinematics refuse."""


class KinematicsError(ValueError):
    """A joint, a body or a way has no meaning; the text says which one and what to do."""
