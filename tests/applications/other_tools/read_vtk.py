"""What VTK's own readers find in a VTKHDF file, as JSON: python read_vtk.py FILE STEP.

steps; counts of cells by VTK's type; the bounds of the points; points, point, cell and field arrays
at the step.
"""

import json
import sys

import vtk
from vtk.util.numpy_support import vtk_to_numpy


def arrays_of(data):
    return {
        data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)).tolist()
        for k in range(data.GetNumberOfArrays())
    }


path = sys.argv[1]
step = int(sys.argv[2])
reader = vtk.vtkHDFReader()
reader.SetFileName(path)
reader.UpdateInformation()
times = list(reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()))
reader.UpdateTimeStep(times[step])
grid = reader.GetOutputDataObject(0)
types = [grid.GetCellType(k) for k in range(grid.GetNumberOfCells())]
print(
    json.dumps(
        {
            "times": times,
            "types": {code: types.count(code) for code in set(types)},
            "points": vtk_to_numpy(grid.GetPoints().GetData()).tolist(),
            "point": arrays_of(grid.GetPointData()),
            "cell": arrays_of(grid.GetCellData()),
            "field": arrays_of(grid.GetFieldData()),
        }
    )
)
