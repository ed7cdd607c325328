"""What the commands of the program refuse, as exceptions: one class for each exit status."""


class Error(Exception):
    """What keeps a command from being done. `str(error)` says what is wrong and where.

    exit_code: the program's exit status for it
    category:  the same in words
    hint:      what to try; may be empty
    """

    exit_code = 1
    category = "failure"

    def __init__(self, message, hint=""):
        super().__init__(message)
        self.hint = hint

    def __str__(self):
        message = self.args[0]
        return f"{message}; {self.hint}" if self.hint else message


class FailureError(Error):
    """An internal failure, or an output that cannot be written."""


class UsageError(Error, ValueError):
    """Options that are unknown, wrong or contradict each other, arrays of the wrong form, more than memory holds."""

    exit_code = 2
    category = "usage"


class InputError(Error):
    """A file or arrays that cannot be read: missing, truncated, not finite, not what they claim to be."""

    exit_code = 3
    category = "unreadable input"


class MeshError(Error):
    """A mesh that was read but bounds no solid: open, flat, without an inside."""

    exit_code = 4
    category = "unusable mesh"


class NothingToRemoveError(Error):
    """No void fits under these limits, or none would save anything."""

    exit_code = 5
    category = "nothing to remove"


_CLASSES = {each.exit_code: each for each in (UsageError, InputError, MeshError, NothingToRemoveError)}


def error_of(exit_code, message, hint):
    """The exception for an exit status."""
    if exit_code == 130:
        return KeyboardInterrupt(message)
    return _CLASSES.get(exit_code, FailureError)(message, hint)
