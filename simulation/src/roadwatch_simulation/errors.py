"""The one error this package raises for anything its user can put right."""


class SimulationError(Exception):
    """A mistake in the input or a missing part: the message says what, where and what to do."""
