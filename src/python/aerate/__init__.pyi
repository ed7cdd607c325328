# Types of the module; tests/python/test_stub.py holds it against the options of the program.

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Optional, Protocol, SupportsFloat, Union

import numpy as np
from numpy.typing import NDArray

_Path = Union[str, bytes, os.PathLike[Any]]
_Value = Union[str, SupportsFloat, _Path, Sequence[float], NDArray[Any], None]  # a sequence of numbers: with commas between them
_List = Union[_Value, Sequence[_Value]]  # a sequence of values: the option several times
_Flag = Optional[bool]
_FlagOrValue = Union[bool, _Value]
_Progress = Optional[Callable[[str, float], object]]  # of the stage, and the share of it that is done

class _Surface(Protocol):
    @property
    def vertices(self) -> Any: ...  # (n, 3), mm
    @property
    def triangles(self) -> Any: ...  # (m, 3)

_Model = Union[_Path, _Surface, tuple[Any, Any], list[Any]]  # or a pair of the two

__version__: str

class Error(Exception):
    exit_code: int
    category: str
    hint: str
    def __init__(self, message: str, hint: str = ...) -> None: ...

class FailureError(Error): ...
class UsageError(Error, ValueError): ...
class InputError(Error): ...
class MeshError(Error): ...
class NothingToRemoveError(Error): ...

@dataclass(frozen=True, eq=False)
class Model:
    vertices: NDArray[np.float64]
    triangles: NDArray[np.int32]
    name: str
    format: str
    parts: int
    notices: tuple[str, ...]
    def __init__(
        self,
        vertices: Any,
        triangles: Any,
        name: str = ...,
        format: str = ...,
        parts: int = ...,
        notices: tuple[str, ...] = ...,
    ) -> None: ...
    def __iter__(self) -> Iterator[Any]: ...

@dataclass(frozen=True, eq=False)
class Packing:
    centres: NDArray[np.float64]
    radii: NDArray[np.float64]
    vertices: Optional[NDArray[np.float64]]
    triangles: Optional[NDArray[np.int32]]
    report: dict[str, Any]

@dataclass(frozen=True, eq=False)
class Hollowed:
    vertices: NDArray[np.float64]
    triangles: NDArray[np.int32]
    report: dict[str, Any]

def load(path: _Path, *, unit: Optional[str] = ..., scale: _Value = ...) -> Model: ...
def inspect(
    model: _Model,
    *,
    progress: _Progress = ...,
    unit: _Value = ...,
    scale: _Value = ...,
    weld: _Value = ...,
    process: _Value = ...,
    up: _Value = ...,
    overhang: _Value = ...,
    bridge: _Value = ...,
    build: _Value = ...,
    picture: _Value = ...,
    picture_cut: _Value = ...,
    picture_size: _Value = ...,
    picture_colour: _Value = ...,
    view: _Value = ...,
    threads: _Value = ...,
    self_intersections: _Flag = ...,
    drainage: _Flag = ...,
    overhangs: _Flag = ...,
    widest_hole: _Value = ...,
    config: _Value = ...,
) -> dict[str, Any]: ...
def pack(
    model: _Model,
    *,
    progress: _Progress = ...,
    unit: _Value = ...,
    scale: _Value = ...,
    weld: _Value = ...,
    process: _Value = ...,
    wall: _Value = ...,
    gap: _Value = ...,
    min_radius: _Value = ...,
    max_radius: _Value = ...,
    overhang: _Value = ...,
    bridge: _Value = ...,
    up: _Value = ...,
    packing: _Value = ...,
    effort: _Value = ...,
    max_voids: _Value = ...,
    target_density: _Value = ...,
    device: _Value = ...,
    keep_solid: _List = ...,
    shape: _Value = ...,
    cell_size: _Value = ...,
    fillet: _Value = ...,
    tolerance: _Value = ...,
    picture: _Value = ...,
    picture_cut: _Value = ...,
    picture_size: _Value = ...,
    picture_colour: _Value = ...,
    view: _Value = ...,
    threads: _Value = ...,
    output: _Value = ...,
    config: _Value = ...,
) -> Packing: ...
def hollow(
    model: _Model,
    *,
    progress: _Progress = ...,
    unit: _Value = ...,
    scale: _Value = ...,
    weld: _Value = ...,
    process: _Value = ...,
    wall: _Value = ...,
    gap: _Value = ...,
    min_radius: _Value = ...,
    max_radius: _Value = ...,
    overhang: _Value = ...,
    bridge: _Value = ...,
    up: _Value = ...,
    packing: _Value = ...,
    effort: _Value = ...,
    max_voids: _Value = ...,
    target_density: _Value = ...,
    device: _Value = ...,
    keep_solid: _List = ...,
    drain: _Flag = ...,
    channel_diameter: _Value = ...,
    hole_diameter: _Value = ...,
    plug_clearance: _Value = ...,
    plug_taper: _Value = ...,
    build: _Value = ...,
    escape_hole: _List = ...,
    holes_on: _List = ...,
    holes_not_on: _List = ...,
    drain_cavities: _Flag = ...,
    plugs: _Value = ...,
    shape: _Value = ...,
    cell_size: _Value = ...,
    fillet: _Value = ...,
    tolerance: _Value = ...,
    infill: _Value = ...,
    infill_pattern: _Value = ...,
    perimeters: _Value = ...,
    line_width: _Value = ...,
    layer_height: _Value = ...,
    top_layers: _Value = ...,
    bottom_layers: _Value = ...,
    slicer_version: _Value = ...,
    vertical_shells: _Value = ...,
    wall_generator: _Value = ...,
    print_settings: _Value = ...,
    force: _Flag = ...,
    picture: _Value = ...,
    picture_cut: _Value = ...,
    picture_size: _Value = ...,
    picture_colour: _Value = ...,
    view: _Value = ...,
    threads: _Value = ...,
    output: _Value = ...,
    as_: _Value = ...,
    flavor: _Value = ...,
    support_blockers: _Flag = ...,
    modifier_infill: _Value = ...,
    modifier_pattern: _Value = ...,
    target_saving: _Value = ...,
    target_mass: _Value = ...,
    stand: _FlagOrValue = ...,
    spheres: _Value = ...,
    max_triangles: _Value = ...,
    surface: _Value = ...,
    voxel: _Value = ...,
    max_hole: _Value = ...,
    material: _Value = ...,
    density: _Value = ...,
    price: _Value = ...,
    price_per: _Value = ...,
    bulk_density: _Value = ...,
    config: _Value = ...,
) -> Hollowed: ...
