"""aerate pack -o packing.vtp, read by VTK, which ParaView reads files with."""

import numpy as np
import pytest
from conftest import BUNNY, run_program
from grains import packed

vtk_xml = pytest.importorskip("vtkmodules.vtkIOXML", reason="python3-vtk9 is not installed")


def test_vtk_reads_points_radii_kinds_and_unit(fresh):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    spheres, kinds = packed(fresh)
    run_program("pack", BUNNY, "-o", "packing.vtp", "--min-radius", 0.5, "--max-voids", 50)
    reader = vtk_xml.vtkXMLPolyDataReader()
    reader.SetFileName("packing.vtp")
    failures = []
    reader.AddObserver("ErrorEvent", lambda *event: failures.append(event))
    reader.Update()
    data = reader.GetOutput()
    assert not failures and data.GetNumberOfPoints() == data.GetNumberOfVerts() == 50
    arrays = data.GetPointData()
    assert arrays.GetScalars().GetName() == "radius"
    points, radii = vtk_to_numpy(data.GetPoints().GetData()), vtk_to_numpy(arrays.GetArray("radius"))
    assert points.dtype == radii.dtype == np.float64
    assert np.array_equal(np.column_stack([points, radii]), spheres)
    names = ["lattice", "interstice", "tetrahedral", "replacement", "adaptive"]
    assert [names[kind] for kind in vtk_to_numpy(arrays.GetArray("kind"))] == kinds
    assert data.GetFieldData().GetAbstractArray("unit").GetValue(0) == "mm"
