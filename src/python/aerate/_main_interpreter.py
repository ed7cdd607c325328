"""Refuses to be imported by a sub-interpreter: pybind11 waits there for ever."""

try:
    import _interpreters
except ImportError:
    try:
        import _xxsubinterpreters as _interpreters  # before Python 3.13
    except ImportError:
        _interpreters = None


def _identity(interpreter):
    return interpreter[0] if isinstance(interpreter, tuple) else interpreter


if _interpreters and _identity(_interpreters.get_current()) != _identity(_interpreters.get_main()):
    raise ImportError("aerate runs in the main interpreter of a process alone, not in a sub-interpreter", name="aerate")
