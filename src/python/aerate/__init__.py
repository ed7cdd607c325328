"""Packs disjoint spheres inside printable models, and removes them, or the cells round them, as voids.

    import aerate

    model = aerate.load("model.stl")                    # or arrays: vertices (n, 3) in mm, triangles (m, 3)
    packing = aerate.pack(model, wall=1.2, max_radius=3)
    result = aerate.hollow(model, process="sla", escape_hole=(12, 20, 0))
    print(packing.centres, packing.radii, result.report["volume"]["removed_percent"])

Options are those of the program by their long names, with underscores: `max_radius=3` is `--max-radius 3`, and
`as_="modifiers"` is `--as modifiers`, `as` being a word of Python. True and False are for flags, a tuple of numbers is
a point, a list gives an option several times, None leaves it out. Lengths are millimetres. What the options are is in
help(aerate.hollow) and `aerate hollow --help`; docs/python.md tells the rest.
"""

from . import _main_interpreter  # first: what it refuses would hang
from ._commands import Hollowed, Model, Packing, hollow, inspect, load, pack
from ._core import version as __version__
from ._errors import Error, FailureError, InputError, MeshError, NothingToRemoveError, UsageError

__all__ = [
    "Error",
    "FailureError",
    "Hollowed",
    "InputError",
    "MeshError",
    "Model",
    "NothingToRemoveError",
    "Packing",
    "UsageError",
    "hollow",
    "inspect",
    "load",
    "pack",
]

# As which they are shown.
for _name in __all__:
    globals()[_name].__module__ = __name__
