"""Checks of the structure of a history file (HDF5), before any value is read."""

import h5py
import numpy as np

from damage.checks import is_plain_name
from damage.errors import InputError
from damage.history import schema

PACKED = 1032
"""What deflate makes of a row of zeros: so many bytes of one."""
_LONGEST_CHUNK = 65536  # rows
_FILTERS = {h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32}
_WORDS = ("solver", "wall", "command", "created_utc", "machine", "parameters_json", "versions_json")
_LENGTHS = ("total_joint_length_m", "drift_height_m", "height_m", "length_m")


def check_structure(file):
    """Check an open file without reading its data; returns the size of the data in bytes.

    Raises InputError where a dataset is missing, is not a dataset, or differs from the schema in shape or type.
    """
    _check_attributes(file)
    version = int(file.attrs["schema_version"])
    tables, codes = schema.tables_of(version), schema.codes_of(version)
    sizes, n_bytes = {}, 0
    for name, column in schema.RUN.items():
        path = f"run/{name}"
        dataset = _dataset(file, path)
        _check_type(path, dataset, column, codes)
        _check_shape(path, dataset, (), sizes, ended=True)
    ended = file["run/status"][()] != 0
    for group, columns in tables.items():
        for name, column in columns.items():
            path = f"{group}/{name}"
            if path in schema.OPTIONAL and name not in file[group]:
                continue
            dataset = _dataset(file, path)
            _check_type(path, dataset, column, codes)
            _check_shape(path, dataset, schema.SHAPES.get(path, schema.SHAPES[group]), sizes, ended)
            n_bytes += _stored(path, dataset)
    for what in ("joints", "bodies", *(["supports"] if tables["supports"] else [])):
        if sizes[what] == 0:
            raise InputError(f"it has no {what}")
    return n_bytes


def stored_bytes(file, path, most):
    """The bytes (n,) of a packed dataset of an open file, at most so many; raises InputError for any other."""
    dataset = _dataset(file, path)
    if dataset.dtype != np.uint8 or dataset.ndim != 1:
        raise InputError(f"{path} is of type {dataset.dtype} and shape {dataset.shape}, expected bytes, uint8 (n,)")
    if _stored(path, dataset) > most:
        raise InputError(f"{path} says it has {dataset.size} bytes, expected up to {most}")
    return dataset[()]


def _check_attributes(file):
    run = file.get("run", getlink=True)
    if not isinstance(run, h5py.HardLink) or not isinstance(file["run"], h5py.Group):
        raise InputError("it has no group run")
    attributes = file["run"].attrs
    for name in _WORDS:
        if not isinstance(attributes.get(name), str):
            raise InputError(f"attribute {name} of run is {_plain(attributes.get(name))!r}, expected words")
    if not is_plain_name(attributes["wall"]):  # files are named after it
        raise InputError(f"attribute wall of run is {attributes['wall']!r:.80}, expected a name without slashes and "
                         "control characters")
    for name in _LENGTHS:
        value = attributes.get(name)
        if not isinstance(value, (float, np.floating)) or not 0 < value < np.inf:
            raise InputError(f"attribute {name} of run is {_plain(value)!r}, expected a length")


def _plain(value):
    """A number as Python's: NumPy 2 prints its own as np.float64(-1.0)."""
    return value.item() if isinstance(value, np.generic) else value


def _dataset(file, path):
    """The dataset at `path` in this file; links to other files are refused."""
    dataset = file
    for name in path.split("/"):
        if not isinstance(dataset, h5py.Group) or not isinstance(dataset.get(name, getlink=True), h5py.HardLink):
            raise InputError(f"it has no dataset {path}")
        dataset = dataset[name]
    if not isinstance(dataset, h5py.Dataset) or dataset.is_virtual or dataset.external:
        raise InputError(f"{path} is no dataset of this file")
    packing = dataset.id.get_create_plist()
    other = {packing.get_filter(k)[0] for k in range(packing.get_nfilters())} - _FILTERS
    if other:  # HDF5 would look for a plug-in
        raise InputError(f"{path} is packed by HDF5 filter {min(other)}, expected gzip alone, shuffled or not")
    return dataset


def _check_type(path, dataset, column, codes):
    expected, unit = np.dtype(column.dtype), dataset.attrs.get("unit", column.unit)
    if dataset.dtype.kind != expected.kind or dataset.dtype.itemsize > 8:
        raise InputError(f"{path} is of type {dataset.dtype}, expected {expected}")
    if not isinstance(unit, str) or unit.split(",")[0] != column.unit.split(",")[0]:
        raise InputError(f"{path} has the unit {unit!r:.80}, expected {column.unit}")
    names, said = codes.get(path), dataset.attrs.get("codes")
    if names and not (isinstance(said, str) and said == ", ".join(names)):  # an array is compared by its elements
        raise InputError(f"{path} has the codes {said!r:.80}, expected {', '.join(names)}")


def _check_shape(path, dataset, expected, sizes, ended):
    """Check that columns of a group have equally many rows; after a kill some may have one flush more."""
    shape = dataset.shape
    if shape is None or len(shape) != len(expected):
        raise InputError(f"{path} has shape {shape}, expected ({', '.join(map(str, expected))})")
    for number, of in zip(shape, expected):
        wanted = of if isinstance(of, int) else sizes.setdefault(of, number)
        if number != wanted and (ended or isinstance(of, int) or of in ("joints", "bodies", "supports")):
            raise InputError(f"{path} has shape {shape}, expected {wanted} {of if of != wanted else ''}".rstrip())
        if not isinstance(of, int):
            sizes[of] = min(number, wanted)


def _stored(path, dataset):
    """Size of the data in memory in bytes; raises InputError where the file cannot hold as much."""
    needed, there = dataset.dtype.itemsize * int(np.prod(dataset.shape, dtype=object)), dataset.id.get_storage_size()
    if needed > PACKED * there:
        raise InputError(f"{path} says it has {needed} bytes where {there} are stored")
    if dataset.chunks and (dataset.chunks[0] > _LONGEST_CHUNK or dataset.chunks[1:] != dataset.shape[1:]):
        raise InputError(f"{path} is stored in chunks of {dataset.chunks}, expected at most {_LONGEST_CHUNK} rows")
    return needed
