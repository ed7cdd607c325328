"""Results are those of the program for the same options, bit by bit."""

import csv
import inspect as python_inspect

import numpy as np
import pytest
from conftest import BUNNY, box, corners_of, cube, run_program, without_costs
from model_files import read_model, write_model

import aerate

HOLLOW_OPTIONS = {
    "spheres": ({"max_radius": 3, "wall": 1.6}, ["--max-radius=3", "--wall=1.6"]),
    "drained": (
        {"process": "sla", "holes_on": "bottom", "cell_size": 15},
        ["--process=sla", "--holes-on=bottom", "--cell-size=15"],
    ),
    "cells": ({"shape": "cells", "drain": False, "fillet": 0.5}, ["--shape=cells", "--no-drain", "--fillet=0.5"]),
    "remeshed": (
        {"surface": "remesh", "voxel": 0.5, "max_voids": 5},
        ["--surface=remesh", "--voxel=0.5", "--max-voids=5"],
    ),
    "standing": ({"stand": True, "up": (0, 0, 1)}, ["--stand", "--up=0,0,1"]),
    "kept": (
        {"keep_solid": ["box:0,0,0,40,40,10", "sphere:14,12,18,2"], "min_radius": np.float64(1.25)},
        ["--keep-solid=box:0,0,0,40,40,10", "--keep-solid=sphere:14,12,18,2", "--min-radius=1.25"],
    ),
}


@pytest.mark.parametrize("options, words", HOLLOW_OPTIONS.values(), ids=HOLLOW_OPTIONS)
def test_hollow_makes_what_the_program_writes(fresh, options, words):
    expected = run_program("hollow", BUNNY, "-o", "expected.ply", *words)
    result = aerate.hollow(BUNNY, **options)
    assert result.vertices.dtype == np.float64 and result.triangles.dtype == np.int32
    assert np.array_equal(corners_of(result), read_model("expected.ply").corners)
    assert without_costs(result.report) == without_costs(expected)
    assert result.report["output"]["path"] is None and result.report["output"]["bytes"] is None
    assert sorted(each.name for each in fresh.iterdir()) == ["expected.ply"]


@pytest.mark.parametrize("ending", ["stl", "3mf", "ply", "obj"])
def test_a_named_output_has_the_bytes_of_the_program(fresh, ending):
    run_program("hollow", BUNNY, "-o", f"expected.{ending}", "--max-radius", 4)
    result = aerate.hollow(BUNNY, output=fresh / f"result.{ending}", max_radius=4)
    assert (fresh / f"result.{ending}").read_bytes() == (fresh / f"expected.{ending}").read_bytes()
    assert result.report["output"]["path"] == str(fresh / f"result.{ending}")
    assert np.array_equal(corners_of(result), read_model(f"result.{ending}").corners)


def test_modifiers_need_a_file_and_are_written(fresh):
    expected = run_program("hollow", BUNNY, "-o", "expected.3mf", "--as", "modifiers")
    result = aerate.hollow(BUNNY, output="result.3mf", as_="modifiers")
    assert (fresh / "result.3mf").read_bytes() == (fresh / "expected.3mf").read_bytes()
    assert without_costs(result.report) == without_costs(expected)
    with pytest.raises(aerate.UsageError, match="modifiers are parts of a file"):
        aerate.hollow(BUNNY, as_="modifiers")


def test_pack_makes_the_spheres_of_the_program(fresh):
    expected = run_program("pack", BUNNY, "-o", "expected.csv", "--min-radius", 0.5, "--max-voids", 40)
    packing = aerate.pack(BUNNY, min_radius=0.5, max_voids=40)
    with open("expected.csv") as table:
        rows = [[float(row[name]) for name in ("x", "y", "z", "radius")] for row in csv.DictReader(table)]
    assert packing.centres.shape == (40, 3) and packing.radii.shape == (40,)
    assert packing.centres.dtype == packing.radii.dtype == np.float64
    assert np.array_equal(np.column_stack([packing.centres, packing.radii]), np.array(rows))
    assert packing.vertices is None and packing.triangles is None
    assert without_costs(packing.report) == without_costs(expected)


def test_pack_makes_the_pieces_of_cells(fresh):
    expected = run_program("pack", BUNNY, "-o", "expected.ply", "--shape", "cells")
    packing = aerate.pack(BUNNY, shape="cells")
    assert np.array_equal(corners_of(packing), read_model("expected.ply").corners)
    assert without_costs(packing.report) == without_costs(expected)
    planes = aerate.pack(BUNNY, shape="cells", output="planes.csv")
    run_program("pack", BUNNY, "-o", "expected.csv", "--shape", "cells")
    assert (fresh / "planes.csv").read_bytes() == (fresh / "expected.csv").read_bytes()
    assert planes.vertices is None and np.array_equal(planes.centres, packing.centres)


@pytest.mark.parametrize("ending", ["csv", "json", "ply", "vtp", "data", "txt"])
def test_pack_writes_the_tables_of_the_program(fresh, ending):
    run_program("pack", BUNNY, "-o", f"expected.{ending}", "--max-voids", 20)
    aerate.pack(BUNNY, output=f"result.{ending}", max_voids=20)
    assert (fresh / f"result.{ending}").read_bytes() == (fresh / f"expected.{ending}").read_bytes()


def test_inspect_reports_what_the_program_does():
    words = ["--self-intersections", "--drainage", "--process=sls"]
    report = aerate.inspect(BUNNY, self_intersections=True, drainage=True, process="sls")
    assert without_costs(report) == without_costs(run_program("inspect", BUNNY, *words))


def test_a_model_is_a_path_arrays_or_what_was_loaded(fresh):
    model = aerate.load(BUNNY)
    vertices, triangles = model
    results = [
        aerate.hollow(each, max_radius=4)
        for each in (BUNNY, str(BUNNY), bytes(BUNNY), model, (vertices, triangles), [vertices, triangles])
    ]
    for result in results[1:]:
        assert np.array_equal(result.vertices, results[0].vertices)
        assert np.array_equal(result.triangles, results[0].triangles)
        assert without_costs(result.report, "input") == without_costs(results[0].report, "input")
    assert [result.report["input"]["path"] for result in results[3:]] == ["bunny.stl", "model", "model"]
    assert results[4].report["input"]["format"] == "arrays"
    facts = [{k: v for k, v in r.report["input"].items() if k not in ("path", "format")} for r in results]
    assert all(each == facts[0] for each in facts)


def test_what_was_hollowed_is_a_model():
    result = aerate.hollow(cube(), max_radius=4)
    report = aerate.inspect(result)
    assert report["input"]["closed"] and report["input"]["shells"] == 1 + result.report["voids"]["count"]
    assert report["input"]["signed_volume_mm3"] == pytest.approx(result.report["volume"]["after_mm3"], rel=1e-9)


def test_load_reads_what_an_independent_reader_reads(fresh):
    model = aerate.load(BUNNY)
    assert model.vertices.dtype == np.float64 and model.triangles.dtype == np.int32
    assert np.array_equal(corners_of(model), read_model(BUNNY).corners)
    assert len(np.unique(model.vertices, axis=0)) == len(model.vertices)
    assert (model.name, model.format, model.parts, model.notices) == ("bunny.stl", "STL", 1, ())
    inches = aerate.load(BUNNY, unit="inch", scale=(1, 1, 2))
    expected = (corners_of(model) * np.array([25.4, 25.4, 50.8])).astype(np.float32)
    assert np.array_equal(corners_of(inches), expected)


def test_arrays_of_any_layout_and_type_are_taken():
    vertices, triangles = cube()
    expected = aerate.pack((vertices, triangles), max_voids=9)
    others = [
        (np.asfortranarray(vertices), np.asfortranarray(triangles)),
        (np.repeat(vertices, 2, axis=0)[::2], triangles.astype(np.uint8)),
        (vertices[::-1][::-1], triangles.astype(np.uint32)),
        (vertices.astype(np.float32), triangles.astype(np.int16)),
        (vertices.astype(int), triangles.tolist()),
        (vertices.tolist(), triangles.astype(">i8")),
    ]
    for model in others:
        packing = aerate.pack(model, max_voids=9)
        assert np.array_equal(packing.centres, expected.centres)
        assert np.array_equal(packing.radii, expected.radii)


def test_arrays_are_left_as_they_are():
    vertices, triangles = cube()
    vertices.setflags(write=False)
    triangles.setflags(write=False)
    aerate.hollow((vertices, triangles), max_radius=4)
    assert np.array_equal(vertices, cube()[0]) and np.array_equal(triangles, cube()[1])


def test_unit_and_scale_hold_for_arrays():
    small = aerate.pack(cube(2.0), unit="cm", max_voids=5)
    scaled = aerate.pack(cube(10.0), scale=2, max_voids=5)
    expected = aerate.pack(cube(20.0), max_voids=5)
    for packing in (small, scaled):
        assert np.array_equal(packing.centres, expected.centres)


def test_points_and_lists_are_written_as_on_the_command_line(fresh):
    model = box((-10, -10, 0), (10, 10, 20))
    write_model("box.stl", model[0][model[1]])
    words = ["--process=sla", "--escape-hole=0,-10,9.5", "--escape-hole=0,10,9.5"]
    expected = run_program("hollow", "box.stl", "-o", "expected.ply", *words)
    result = aerate.hollow(model, process="sla", escape_hole=[(0, -10, 9.5), np.array([0, 10, 9.5])])
    assert np.array_equal(corners_of(result), read_model("expected.ply").corners)
    assert result.report["drainage"] == expected["drainage"]
    one = aerate.hollow(model, process="sla", escape_hole=(0, -10, 9.5))
    purposes = [[hole["purpose"] for hole in each.report["drainage"]["holes"]] for each in (result, one)]
    assert [each.count("asked") for each in purposes] == [2, 1]


def test_none_leaves_an_option_out_and_false_turns_one_off():
    expected = aerate.hollow(cube(), max_radius=4)
    same = aerate.hollow(cube(), max_radius=4, wall=None, stand=False, support_blockers=False, drain=False)
    assert np.array_equal(same.vertices, expected.vertices)


def test_a_configuration_file_counts(fresh):
    (fresh / "options.toml").write_text("[pack]\nmax-voids = 3\n")
    assert len(aerate.pack(cube(), config="options.toml").radii) == 3
    assert len(aerate.pack(cube(), config="options.toml", max_voids=2).radii) == 2


def test_threads_change_nothing():
    one, three = (aerate.hollow(BUNNY, threads=count, max_radius=4) for count in (1, 3))
    assert np.array_equal(one.vertices, three.vertices) and np.array_equal(one.triangles, three.triangles)


def test_pictures_and_plugs_are_made_beside_the_arrays(fresh):
    aerate.hollow(BUNNY, process="sla", picture="cut.png", plugs="plugs.stl")
    assert (fresh / "cut.png").read_bytes().startswith(b"\x89PNG")
    assert len(read_model("plugs.stl").corners) > 0


def test_nothing_is_printed(capfd):
    result = aerate.hollow(box((0, 0, 0), (20, 20, 20), inward=True), max_radius=4)
    assert any("inside out" in notice or "turned" in notice for notice in result.report["notices"])
    assert capfd.readouterr() == ("", "")


def test_version_is_the_programs():
    assert aerate.inspect(cube())["program"] == f"aerate {aerate.__version__}"


def test_help_has_shapes_units_and_every_option():
    text = python_inspect.getdoc(aerate.hollow)
    assert "(n, 3) in mm" in text and "max_radius: MM" in text and "escape_hole: X,Y,Z, or a list of such" in text
