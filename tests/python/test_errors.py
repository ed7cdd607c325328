"""What is refused: by which exception, and in which words."""

import decimal
import errno
import fractions
import os
import pickle

import numpy as np
import pytest
from conftest import BUNNY, PROGRAM, box, cube

import aerate


def refused(kind, function, *arguments, **options):
    """The exception, which has to be of just this kind."""
    with pytest.raises(aerate.Error) as caught:
        function(*arguments, **options)
    assert type(caught.value) is kind, repr(caught.value)
    return caught.value


def test_categories_are_the_exit_statuses():
    kinds = [
        aerate.FailureError,
        aerate.UsageError,
        aerate.InputError,
        aerate.MeshError,
        aerate.NothingToRemoveError,
    ]
    assert [kind.exit_code for kind in kinds] == [1, 2, 3, 4, 5]
    assert len({kind.category for kind in kinds}) == 5
    assert all(issubclass(kind, aerate.Error) for kind in kinds)
    assert issubclass(aerate.UsageError, ValueError)


@pytest.mark.parametrize(
    "options, words",
    [
        ({"wal": 1}, "hollow has no option 'wal'; did you mean 'wall'?"),
        ({"json": "report.json"}, "hollow has no option 'json'"),
        ({"help": True}, "hollow has no option 'help'"),
        ({"wall": "thick"}, "'thick' is not a number"),
        ({"wall": float("nan")}, "'nan' is not a number"),
        ({"wall": -1}, "too little"),
        ({"wall": True}, "--wall needs a value"),
        ({"wall": 1 + 2j}, "--wall: (1+2j) is no value"),
        ({"wall": [1, 2]}, "'1,2' is not a number"),
        ({"wall": {"mm": 1}}, "is no value"),
        ({"packing": "cubic"}, "cubic"),
        ({"process": "list"}, "--process list is for the command line"),
        ({"process": "cnc"}, "cnc"),
        ({"support_blockers": "yes"}, "--support-blockers takes no value"),
        ({"escape_hole": (1, 2), "process": "sla"}, "1,2"),
        ({"scale": (1, 0, 1)}, "too little"),
        ({"min_radius": 3, "max_radius": 2}, "max-radius"),
        ({"drain": False, "escape_hole": (1, 2, 3)}, "escape-hole"),
        ({"output": "result.docx"}, ".docx"),
        ({"output": "a\0.stl"}, "null character"),
        ({"output": ""}, "--output: '' is no value"),
        ({"stand": ""}, "--stand: '' is no value"),
        ({"escape_hole": ["1,2,3", ""], "process": "sla"}, "--escape-hole: '' is no value"),
        ({"config": "there-is-none.toml"}, "there-is-none.toml"),
    ],
)
def test_wrong_options_are_usage(fresh, options, words):
    error = refused(aerate.UsageError, aerate.hollow, cube(), **options)
    assert words in str(error)
    assert list(fresh.iterdir()) == []


def test_messages_are_those_of_the_program(fresh):
    import subprocess

    done = subprocess.run([PROGRAM, "hollow", BUNNY, "-o", "x.stl", "--wall", "1", "--gap=-2"], capture_output=True)
    assert done.returncode == 2
    error = refused(aerate.UsageError, aerate.hollow, BUNNY, wall=1, gap=-2)
    assert error.args[0] in done.stderr.decode() and error.hint in done.stderr.decode()


@pytest.mark.parametrize(
    "model, words",
    [
        (7, "int is no model"),
        (None, "NoneType is no model"),
        ((1, 2, 3), "tuple is no model"),
        ((np.zeros((4, 2)), cube()[1]), "vertices have the shape (4, 2)"),
        ((np.zeros(12), cube()[1]), "vertices have the shape (12,)"),
        ((cube()[0], cube()[1].ravel()), "triangles have the shape (36,)"),
        ((cube()[0], np.zeros((6, 4), int)), "triangles have the shape (6, 4)"),
        ((cube()[0], cube()[1].astype(float)), "triangles are of type float64"),
        ((cube()[0] > 0, cube()[1]), "vertices are of type bool"),
        ((cube()[0].astype(complex), cube()[1]), "vertices are of type complex128"),
        ((cube()[0].astype(str), cube()[1]), "vertices are of type <U"),
        ((cube()[0].astype(object), cube()[1]), "vertices are of type object"),
        ((None, cube()[1]), "vertices are of type object"),
        ("a\0.stl", "null character"),
    ],
)
@pytest.mark.parametrize("function", [aerate.inspect, aerate.pack, aerate.hollow])
def test_what_is_no_model_is_usage(function, model, words):
    assert words in str(refused(aerate.UsageError, function, model))


def changed(array, row, value):
    array = np.array(array)
    array[row] = value
    return array


@pytest.mark.parametrize(
    "model, words",
    [
        ((changed(cube()[0], 5, np.nan), cube()[1]), "vertices[5] is (nan, nan, nan)"),
        ((changed(cube()[0], (2, 1), np.inf), cube()[1]), "vertices[2]"),
        ((changed(cube()[0], (2, 1), 1e300), cube()[1]), "too large for single precision"),
        ((cube()[0], changed(cube()[1], (3, 2), 8)), "triangles[3] is ("),
        ((cube()[0], changed(cube()[1], (11, 0), -1)), "triangles[11] is (-1, "),
        ((cube()[0], changed(cube()[1].astype(np.uint64), (1, 1), 2**64 - 1)), "triangles[1]"),
        ((np.zeros((0, 3)), cube()[1]), "there are 0 vertices"),
        ((cube()[0], np.zeros((0, 3), int)), "no triangles"),
        ("there-is-none.stl", "there-is-none.stl"),
        (os.sep, "folder"),
    ],
)
@pytest.mark.parametrize("function", [aerate.inspect, aerate.pack, aerate.hollow])
def test_unreadable_models_are_input(function, model, words):
    error = refused(aerate.InputError, function, model)
    assert words in str(error).replace("directory", "folder")


def test_files_that_are_no_models_are_input(fresh):
    (fresh / "empty.stl").write_bytes(b"")
    (fresh / "cut.stl").write_bytes(BUNNY.read_bytes()[:5000])
    (fresh / "letter.docx").write_bytes(b"text")
    for name in ("empty.stl", "cut.stl", "letter.docx"):
        for function in (aerate.load, aerate.inspect, aerate.hollow):
            assert name in str(refused(aerate.InputError, function, name))
    assert "pathlib" not in str(refused(aerate.UsageError, aerate.load, cube()))
    refused(aerate.UsageError, aerate.load, BUNNY, unit="mile")


def test_meshes_without_an_inside_are_mesh():
    vertices, triangles = cube()
    for function in (aerate.pack, aerate.hollow):
        refused(aerate.MeshError, function, (vertices, triangles[:6]))
        refused(aerate.MeshError, function, (vertices * np.array([1, 1, 0]), triangles))
    assert not aerate.inspect((vertices, triangles[:6]))["input"]["closed"]


def test_thin_models_have_nothing_to_remove():
    for function in (aerate.pack, aerate.hollow):
        error = refused(aerate.NothingToRemoveError, function, cube(), wall=11)
        assert error.exit_code == 5 and "--wall" in error.hint


def test_outputs_that_cannot_be_written_are_failures(fresh):
    error = refused(aerate.FailureError, aerate.hollow, cube(), output="no/such/folder/x.stl")
    assert error.exit_code == 1 and os.strerror(errno.ENOENT) in str(error)


def test_no_input_is_overwritten(fresh):
    (fresh / "model.stl").write_bytes(BUNNY.read_bytes())
    error = refused(aerate.UsageError, aerate.hollow, "model.stl", output="./model.stl")
    assert "the output is the model itself" in str(error)
    assert (fresh / "model.stl").read_bytes() == BUNNY.read_bytes()


def test_arrays_may_be_called_as_their_output(fresh):
    model = aerate.Model(*cube(), name="model.stl")
    aerate.hollow(model, output="model.stl", max_radius=4)
    assert (fresh / "model.stl").exists()


def test_a_model_is_named_in_messages():
    error = refused(aerate.NothingToRemoveError, aerate.hollow, aerate.Model(*cube(), name="plinth"), wall=11)
    assert str(error).startswith("plinth: ")


def test_more_than_memory_holds_is_usage():
    error = refused(aerate.UsageError, aerate.pack, box((0, 0, 0), (9e4, 9e4, 9e4)), packing="hexagonal", max_radius=0.7)
    assert "memory" in str(error) or "GB" in str(error)


def test_names_that_are_no_text_are_taken(fresh):
    name = os.fsdecode(b"caf\xe9.stl")
    (fresh / name).write_bytes(BUNNY.read_bytes())
    assert aerate.load(name).name == name
    assert aerate.inspect(name)["input"]["closed"]
    error = refused(aerate.InputError, aerate.load, os.fsdecode(b"none\xff.stl"))
    assert "none" in str(error)


def test_names_like_options_are_names(fresh):
    (fresh / "--help").mkdir()
    (fresh / "-x.stl").write_bytes(BUNNY.read_bytes())
    assert aerate.inspect("-x.stl")["input"]["closed"]
    refused(aerate.InputError, aerate.inspect, "--help")
    refused(aerate.InputError, aerate.inspect, "")


def test_errors_can_be_sent_to_other_processes():
    error = refused(aerate.NothingToRemoveError, aerate.hollow, cube(), wall=11)
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error) and str(again) == str(error) and again.hint == error.hint


def test_callbacks_that_cannot_be_called_are_usage():
    refused(aerate.UsageError, aerate.hollow, cube(), progress=1)


def test_arrays_that_are_none_are_told():
    vertices, triangles = cube()
    uneven = [[0, 0, 0], [1, 0]]
    assert "vertices are no array" in str(refused(aerate.UsageError, aerate.inspect, (uneven, triangles)))
    masked = np.ma.masked_less(vertices, 1)
    assert "vertices are masked" in str(refused(aerate.UsageError, aerate.inspect, (masked, triangles)))
    far = triangles.astype(np.uint64)
    far[4, 0] = 2**63 + 5
    assert f"triangles[4] is ({2**63 + 5}, {far[4, 1]}, {far[4, 2]})" in str(refused(aerate.InputError, aerate.inspect, (vertices, far)))
    packing = aerate.pack((vertices, triangles), max_radius=4)
    assert "this has no surface" in str(refused(aerate.UsageError, aerate.hollow, packing))
    named = aerate.Model(vertices, triangles, name=5)
    assert "the model's name: 5 is no name" in str(refused(aerate.UsageError, aerate.inspect, named))
    assert "is no name" in str(refused(aerate.UsageError, aerate.load, "a\ud800.stl"))


def test_numbers_of_any_kind_are_values():
    expected = aerate.pack(cube(), wall=1.5, max_voids=3).report["packing"]
    for wall, voids in ((np.float32(1.5), 3.0), (decimal.Decimal("1.5"), np.array(3)), (fractions.Fraction(3, 2), np.int8(3))):
        assert aerate.pack(cube(), wall=wall, max_voids=voids).report["packing"] == expected


def test_a_configuration_file_may_have_sections_of_other_commands(fresh):
    (fresh / "all.toml").write_text("[hollow]\nmax-voids = 2\n[pack]\nmax-voids = 3\n[batch]\njobs = 2\n[studio]\nport = 9\n")
    assert aerate.hollow(cube(), config="all.toml").report["voids"]["count"] == 2
    assert len(aerate.pack(cube(), config="all.toml").radii) == 3
    aerate.inspect(cube(), config="all.toml")
    (fresh / "wrong.toml").write_text("[hollo]\nmax-voids = 2\n")
    refused(aerate.UsageError, aerate.hollow, cube(), config="wrong.toml")
