"""load, inspect, pack and hollow. Options become the words of a command line, which the program's own code reads."""

import atexit
import dataclasses
import decimal
import difflib
import functools
import json
import keyword
import numbers
import os
import typing

import numpy as np

from . import _core
from ._errors import InputError, UsageError


# Jobs of threads that Python does not wait for are stopped before it ends.
atexit.register(_core.end_jobs)
os.register_at_fork(after_in_child=_core.forget_jobs)


@dataclasses.dataclass(frozen=True, eq=False)
class Model:
    """A closed surface of triangles.

    vertices:  float64, shape (n, 3), mm; a model that was loaded has single precision, as files have
    triangles: int32, shape (m, 3), rows of `vertices`, counter-clockwise seen from outside
    name:      what messages and reports call it
    format:    of the file, "STL", "3MF", ..
    parts:     objects in the file; all are in the arrays
    notices:   what reading it left out or mended, a sentence each
    """

    vertices: np.ndarray
    triangles: np.ndarray
    name: str = "model"
    format: str = "arrays"
    parts: int = 1
    notices: tuple = ()

    def __iter__(self):
        """For `vertices, triangles = aerate.load(path)`."""
        return iter((self.vertices, self.triangles))


@dataclasses.dataclass(frozen=True, eq=False)
class Packing:
    """Spheres in a model, in its coordinates.

    centres:   float64, shape (n, 3), mm
    radii:     float64, shape (n,), mm
    vertices, triangles: with shape="cells" the pieces of the cells as closed shells (as of a Model), else None
    report:    what `aerate pack --json` writes (docs/report.md)
    """

    centres: np.ndarray
    radii: np.ndarray
    vertices: typing.Optional[np.ndarray]
    triangles: typing.Optional[np.ndarray]
    report: dict


@dataclasses.dataclass(frozen=True, eq=False)
class Hollowed:
    """A model with voids: first the outer surface, then the voids and what joins them, facing into the hollow.

    vertices:  float64, shape (n, 3), mm; single precision, as files have
    triangles: int32, shape (m, 3), rows of `vertices`, counter-clockwise seen from outside the material
    report:    what `aerate hollow --json` writes (docs/report.md)
    """

    vertices: np.ndarray
    triangles: np.ndarray
    report: dict


class _Option(typing.NamedTuple):
    name: str  # of the command line, without dashes
    is_list: bool
    is_flag: bool
    may_be_off: bool
    may_be_bare: bool
    value: str
    description: str

    @property
    def takes_flag(self):
        return self.is_flag or self.may_be_bare

    @property
    def takes_value(self):
        return not self.is_flag or self.may_be_bare


def _in_python(name):
    """An option's name as that of a parameter: max_radius, as_."""
    return name.replace("-", "_") + "_" * keyword.iskeyword(name)


@functools.cache
def _options(command):
    """By their names in Python."""
    rows = (_Option(*row) for row in _core.options(command))
    return {_in_python(row.name): row for row in rows}


def _is_number(value):
    return isinstance(value, numbers.Real) and not isinstance(value, (bool, np.bool_))


def _items(value):
    """Of a list, a tuple or an array; None of anything else."""
    return list(value) if isinstance(value, (list, tuple)) or getattr(value, "ndim", 0) > 0 else None


def _is_point(items):
    return bool(items) and all(map(_is_number, items))


def _bytes_of(what, text):
    """A name as the system has it."""
    try:
        return os.fsencode(text)
    except (TypeError, UnicodeError) as error:
        raise UsageError(f"{what}: {text!r} is no name: {error}") from None


def _word(option, value):
    """A value as it is written on a command line."""
    if isinstance(value, (str, bytes, os.PathLike)) and value:
        return _bytes_of(f"--{option.name}", value)
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, numbers.Integral) and _is_number(value):
        return b"%d" % int(value)
    if _is_number(value) or isinstance(value, decimal.Decimal):
        return repr(float(value)).removesuffix(".0").encode()
    items = _items(value)
    if _is_point(items):
        return b",".join(_word(option, each) for each in items)
    raise UsageError(f"--{option.name}: {value!r} is no value", "give a number, a string, a path, or a tuple of numbers")


def _values(option, value):
    """Those of an option that is given more than once, or the one."""
    items = _items(value)
    return [value] if not option.is_list or items is None or _is_point(items) else items


def _arguments(command, options):
    """Options as the words of a command line."""
    known = _options(command)
    words = []
    for name, value in options.items():
        option = known.get(name)
        if option is None:
            close = difflib.get_close_matches(name, known, n=1)
            hint = f"did you mean '{close[0]}'?" if close else f"see help(aerate.{command})"
            if name in ("json", "quiet"):
                hint = "a call returns its report and prints nothing"
            raise UsageError(f"{command} has no option '{name}'", hint)
        if value is None:
            continue
        if isinstance(value, (bool, np.bool_)):
            if not option.takes_flag:
                raise UsageError(f"--{option.name} needs a value", option.description)
            if value:
                words.append(b"--" + option.name.encode())
            elif option.may_be_off:
                words.append(b"--no-" + option.name.encode())
            continue
        if not option.takes_value:
            raise UsageError(f"--{option.name} takes no value", "give True or False")
        words += (b"--%s=%s" % (option.name.encode(), _word(option, each)) for each in _values(option, value))
    if any(b"\0" in word for word in words):
        raise UsageError("a value holds a null character")
    return words


def _rows(what, array, kinds, dtype):
    """As rows of three, contiguous."""
    if isinstance(array, np.ma.MaskedArray) and np.ma.is_masked(array):
        raise UsageError(f"{what} are masked", "leave out what is masked: give the array's compressed rows")
    try:
        array = np.asarray(array)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{what} are no array: {error}", "give an array of shape (n, 3)") from None
    if array.dtype.kind not in kinds:
        hint = "this has no surface" if array.dtype.kind == "O" and array.ndim == 0 else f"give an array of {np.dtype(dtype).name}"
        raise UsageError(f"{what} are of type {array.dtype}", hint)
    if array.ndim != 2 or array.shape[1] != 3:
        raise UsageError(f"{what} have the shape {array.shape}", "give an array of shape (n, 3)")
    if dtype is np.int64 and array.size and int(array.max()) > np.iinfo(np.int64).max:
        first = int(np.argmax((array > np.uint64(np.iinfo(np.int64).max)).any(axis=1)))
        row = tuple(map(int, array[first]))
        raise InputError(f"{what}[{first}] is {row}", "triangles hold rows of the vertices, counted from 0")
    with np.errstate(over="ignore"):  # what is not finite is refused
        return np.ascontiguousarray(array, dtype=dtype)


def _source(model):
    """What a model is called, its vertices and its triangles; None where a file has them."""
    if isinstance(model, (str, bytes, os.PathLike)):
        name = _bytes_of("model", model)
        if b"\0" in name:
            raise UsageError("the model's name holds a null character")
        return name, None, None
    if isinstance(model, (tuple, list)) and len(model) == 2:
        model = Model(*model)
    if not hasattr(model, "vertices") or not hasattr(model, "triangles"):
        raise UsageError(f"{type(model).__name__} is no model", "give a path, a Model, or a pair (vertices, triangles)")
    vertices = _rows("vertices", model.vertices, "fiu", np.float64)
    triangles = _rows("triangles", model.triangles, "iu", np.int64)
    return _bytes_of("the model's name", getattr(model, "name", "model")), vertices, triangles


def _run(command, model, progress, options):
    if progress is not None and not callable(progress):
        raise UsageError("progress cannot be called", "give a function of a stage and a fraction")
    report, *arrays = _core.run(command, *_source(model), _arguments(command, options), progress)
    return [json.loads(report), *arrays]


def load(path, *, unit=None, scale=None):
    """Reads a model: STL, 3MF, OBJ, PLY, OFF, GLB, glTF or 3DS. All parts become one; equal vertices are joined.

    unit:  of the file's coordinates, "mm", "cm", "m" or "inch"; 3MF and glTF files have their own (default mm)
    scale: factor for the size, or (x, y, z)

    Returns a Model, in mm. Raises InputError, and UsageError for a unit that contradicts the file.
    """
    if not isinstance(path, (str, bytes, os.PathLike)):
        raise UsageError(f"{type(path).__name__} is no path")
    facts, _, _, vertices, triangles = _run("load", path, None, {"unit": unit, "scale": scale})
    name = os.path.basename(os.fsdecode(path))
    return Model(vertices, triangles, name, facts["format"], facts["parts"], tuple(facts["notices"]))


def inspect(model, *, progress=None, **options):
    """Tells what is right and wrong with a model.

    model:    a path, a Model, or a pair (vertices, triangles): float64 (n, 3), mm unless `unit` says else, and
              integers (m, 3), rows of the vertices
    progress: function of the stage (str) and of the share of it that is done (0 to 1); what it raises stops the work

    Returns the report as a dictionary: what `aerate inspect --json` writes (docs/report.md). Raises subclasses of
    Error, and KeyboardInterrupt. Options are those of `aerate inspect`:
    """
    return _run("inspect", model, progress, options)[0]


def pack(model, *, progress=None, **options):
    """Packs spheres in a closed model. With `output` they are written to that file, too.

    model:    a path, a Model, or a pair (vertices, triangles): float64 (n, 3), mm unless `unit` says else, and
              integers (m, 3), rows of the vertices
    progress: function of the stage (str) and of the share of it that is done (0 to 1); what it raises stops the work

    Returns a Packing: centres (n, 3) and radii (n,) in mm, and the report. Raises subclasses of Error, and
    KeyboardInterrupt. Options are those of `aerate pack`:
    """
    report, centres, radii, vertices, triangles = _run("pack", model, progress, options)
    has_pieces = len(triangles) > 0
    return Packing(centres, radii, vertices if has_pieces else None, triangles if has_pieces else None, report)


def hollow(model, *, progress=None, **options):
    """Removes packed spheres, or the cells round them, from a model. With `output` the result is written to that
    file, too; without it, it is checked as if it had been.

    model:    a path, a Model, or a pair (vertices, triangles): float64 (n, 3), mm unless `unit` says else, and
              integers (m, 3), rows of the vertices
    progress: function of the stage (str) and of the share of it that is done (0 to 1); what it raises stops the work

    Returns a Hollowed: vertices (n, 3) in mm, triangles (m, 3), and the report. Raises subclasses of Error, and
    KeyboardInterrupt. Options are those of `aerate hollow`:
    """
    report, _, _, vertices, triangles = _run("hollow", model, progress, options)
    return Hollowed(vertices, triangles, report)


def _described(command):
    """All options of a command, for its documentation."""
    lines = []
    for name, option in _options(command).items():
        value = option.value or "True or False"
        lines.append(f"\n    {name}: {value}{', or a list of such' if option.is_list else ''}\n        {option.description}")
    return "".join(lines) + "\n"


for _function in (inspect, pack, hollow):
    if _function.__doc__:  # not with python -OO
        _function.__doc__ += _described(_function.__name__)
