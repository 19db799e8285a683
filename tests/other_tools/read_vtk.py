"""What VTK's own readers find in a VTKHDF or a PVD file, as JSON: python read_vtk.py FILE STEP.

steps; counts of cells by VTK's type; the bounds of the points; points, point, cell and field arrays at the step.
"""

import json
import sys
from pathlib import Path
from xml.etree import ElementTree

import vtk
from vtk.util.numpy_support import vtk_to_numpy


def grid_of_vtkhdf(path, step):
    reader = vtk.vtkHDFReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    reader.UpdateTimeStep(times[step])
    return list(times), reader.GetOutputDataObject(0)


def grid_of_pvd(path, step):
    listed = ElementTree.parse(path).findall(".//DataSet")
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(Path(path).parent / listed[step].get("file")))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return [float(one.get("timestep")) for one in listed], reader.GetOutput()


def arrays_of(data):
    return {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)).tolist() for k in range(data.GetNumberOfArrays())}


path, step = sys.argv[1], int(sys.argv[2])
times, grid = (grid_of_vtkhdf if path.endswith(".vtkhdf") else grid_of_pvd)(path, step)
types = [grid.GetCellType(k) for k in range(grid.GetNumberOfCells())]
print(json.dumps({
    "times": times, "types": {code: types.count(code) for code in set(types)},
    "points": vtk_to_numpy(grid.GetPoints().GetData()).tolist(),
    "point": arrays_of(grid.GetPointData()), "cell": arrays_of(grid.GetCellData()),
    "field": arrays_of(grid.GetFieldData())}))
