"""What a procedure refuses or gives up, and why."""


class ProcedureError(Exception):
    """Root of the errors of the procedures room; the text says what to do."""


class RejectedError(ProcedureError):
    """What was measured is no use: what is stored would end the run in the same way, so it never goes on."""


class PlanError(ProcedureError):
    """The plan cannot be made from this configuration."""


class PlanLimitError(PlanError):
    """The plan would violate a limit of the robot."""


class BeamLostError(ProcedureError):
    """The beam is lost and could not be found again."""


class TableFileError(ProcedureError):
    """A file that the operator named cannot be used; the text names file, line and remedy."""


class NoBeamError(ProcedureError):
    """The instrument refused since no beam returned at that moment."""


class ArmMovedError(ProcedureError):
    """Somebody has moved the arm while a run was held or suspended; the rest of its way is not driven."""


class StepCutShortError(ProcedureError):
    """A relative motion was cut short: what is left of it is unknown, and it is not sent again."""


class WayBlockedError(ProcedureError):
    """There is no free way from where the arm stands to where it has to go."""


class ManualStepError(ProcedureError):
    """A step by hand that cannot be made: nothing of that name moves, or what is aimed at is elsewhere."""


class ReflectorNotFoundError(RejectedError):
    """A search did not find a reflector, or not well enough to aim at it."""


class NotPlacedError(ProcedureError):
    """The operator did not put a reflector into its nest."""


class CounterError(RejectedError):
    """The sign or the scale of the counter is wrong."""


class SlowCounterError(ProcedureError):
    """The counter is read too seldom for what comes after the measurement."""


class MostLeftOutError(RejectedError):
    """A measurement left out most of its points."""


class AlignmentError(ProcedureError):
    """The beam could not be aligned within the tolerance."""


class NotWarmError(RejectedError):
    """The drift of a distance is not below its limit after the longest permitted warm-up."""


class HiddenTargetsError(ProcedureError):
    """An instrument beside the arm saw too few targets for what they are to show."""


class OutOfReachError(ProcedureError):
    """A gauge would have to be longer or shorter than it can be."""
