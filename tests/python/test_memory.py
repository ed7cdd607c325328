"""Nothing is kept: of results, of errors, of callbacks."""

import gc
import weakref

import numpy as np
import pytest
from conftest import cube

import aerate


def held_bytes():
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) * 1024 for line in status if line.startswith("RssAnon"))


def finely_divided(model, times):
    """The same box of 4^times as many triangles."""
    vertices, triangles = model
    corners = vertices[triangles]
    for _ in range(times):
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        corners = np.concatenate([np.stack(each, axis=1) for each in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    rows, numbers = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return rows, numbers.reshape(-1, 3)


def test_fifty_runs_hold_no_more_than_five():
    model = finely_divided(cube(), 5)  # 12,288 triangles: 0.4 MB, and as much of a result

    def run():
        aerate.hollow(model, max_voids=2, tolerance=0.2, threads=2, progress=lambda stage, share: None)
        aerate.inspect(model)
        with pytest.raises(aerate.MeshError):
            aerate.pack((model[0], model[1][:-9]))

    held = []
    for _ in range(50):
        run()
        gc.collect()
        held.append(held_bytes())
    # What one run makes, kept, would be 20 MB.
    assert max(held[-5:]) - max(held[5:10]) < 6e6, held


def test_callbacks_and_arrays_are_let_go():
    class Callback:
        def __call__(self, stage, share):
            pass

    class Array(np.ndarray):
        pass

    callback, vertices = Callback(), cube()[0].view(Array)
    gone = [weakref.ref(callback), weakref.ref(vertices)]
    result = aerate.hollow((vertices, cube()[1]), max_radius=4, progress=callback)
    gone.append(weakref.ref(result.vertices))
    del callback, vertices, result
    gc.collect()
    assert [each() for each in gone] == [None, None, None]


def test_results_outlive_what_they_were_made_of():
    model = aerate.Model(*cube())
    result = aerate.hollow(model, max_radius=4)
    copy = result.vertices.copy()
    del model
    gc.collect()
    aerate.hollow(cube(30), max_radius=4)
    assert np.array_equal(result.vertices, copy) and result.vertices.flags.owndata and result.vertices.flags.writeable
