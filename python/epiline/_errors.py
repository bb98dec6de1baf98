"""Exceptions of the package. Their sentences are those of the command line."""


class EpilineError(Exception):
    """Base of all exceptions of the package."""


class InputError(EpilineError, ValueError):
    """The input is wrong: a file, an array, a camera, or a parameter."""


class NoGeometryError(EpilineError, RuntimeError):
    """The input is sound, but no epipolar geometry follows from it."""
