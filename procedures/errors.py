"""What a procedure refuses or gives up, and why."""


class ProcedureError(Exception):
    """Root of the errors of the procedures room; the text says what to do."""


class PlanError(ProcedureError):
    """The plan cannot be made from this configuration."""


class PlanLimitError(PlanError):
    """The plan would violate a limit of the robot."""


class BeamLostError(ProcedureError):
    """The beam is lost and could not be found again."""


class ReflectorNotFoundError(ProcedureError):
    """A search did not find a reflector, or not well enough to aim at it."""
