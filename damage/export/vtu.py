"""A history as VTU files, one a snapshot, and a PVD file that lists them with their times: for every ParaView.

A file holds the whole grid: `damage.export.vtkhdf` is smaller and has every sample, where ParaView is 5.12 or newer.
The format is that of VTK's XML files, arrays inline in base 64 and compressed by zlib:
https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import base64
import sys
import zlib
from pathlib import Path
from xml.etree import ElementTree as Xml

import numpy as np

from damage.errors import InputError
from damage.export.cells import WallCells
from damage.files import whole_or_nothing

_TYPES = {"f4": "Float32", "f8": "Float64", "i1": "Int8", "u1": "UInt8", "i8": "Int64"}


def write_vtu(history, folder):
    """Write FOLDER/STEM_NNNN.vtu of every snapshot of a History and FOLDER/STEM.pvd; returns the path of the latter.

    Raises InputError where the history holds no snapshot, or a file cannot be written.
    """
    cells, stem = WallCells(history), history.path.stem
    if len(history.snapshot_time_s) == 0:
        raise InputError(f"{history.path} holds no snapshot yet; expected one or more, let the run continue")
    listed = _root("Collection")
    collection = Xml.SubElement(listed, "Collection")
    for snapshot, sample in zip(cells.snapshots, cells.sample_of):
        name = f"{stem}_{snapshot:04d}.vtu"
        _write(_grid(cells, snapshot, sample), Path(folder) / name)
        Xml.SubElement(collection, "DataSet", timestep=repr(float(history.snapshot_time_s[snapshot])), part="0",
                       file=name)
    return _write(listed, Path(folder) / f"{stem}.pvd")


def _grid(cells, snapshot, sample):
    """The XML of one VTU file."""
    file = _root("UnstructuredGrid")
    grid = Xml.SubElement(file, "UnstructuredGrid")
    numbers = {"TimeValue": cells.history.snapshot_time_s[snapshot], **cells.numbers.iloc[sample]}
    _arrays(grid, "FieldData", {name: np.array([value]) for name, value in numbers.items()}, NumberOfTuples="1")
    piece = Xml.SubElement(grid, "Piece", NumberOfPoints=str(len(cells.points)), NumberOfCells=str(len(cells.types)))
    _arrays(piece, "Points", {"Points": cells.points})
    _arrays(piece, "Cells", {"connectivity": cells.connectivity, "offsets": cells.offsets[1:], "types": cells.types})
    _arrays(piece, "PointData", {"displacement_m": cells.displacement(snapshot)})
    _arrays(piece, "CellData", {**cells.body_fields(snapshot), **cells.joint_fields(sample), **cells.fixed})
    return file


def _root(kind):
    order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    return Xml.Element("VTKFile", type=kind, version="1.0", byte_order=order, header_type="UInt64",
                       compressor="vtkZLibDataCompressor")


def _arrays(parent, kind, arrays, **more):
    """A group of arrays (n,) or (n, components); more: attributes of each."""
    group = Xml.SubElement(parent, kind)
    for name, values in arrays.items():
        array = Xml.SubElement(group, "DataArray", type=_TYPES[values.dtype.str[1:]], Name=name, format="binary",
                               NumberOfComponents=str(values.shape[1] if values.ndim > 1 else 1), **more)
        array.text = _packed(np.ascontiguousarray(values).tobytes())


def _packed(data):
    """Bytes as one compressed block: number of blocks, bytes of a whole one and of a last shorter one, of each packed;
    then the block."""
    packed = zlib.compress(data)
    head = np.array([1, len(data), 0, len(packed)], np.uint64).tobytes()
    return (base64.b64encode(head) + base64.b64encode(packed)).decode()


def _write(root, path):
    with whole_or_nothing(path) as unfinished:
        Xml.ElementTree(root).write(unfinished, encoding="utf-8", xml_declaration=True)
    return path
