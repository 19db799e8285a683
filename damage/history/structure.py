"""Checks of a history file (HDF5): of its structure before any value is read, then of its values."""

import h5py
import numpy as np

from damage.checks import check_number, is_plain_name
from damage.errors import InputError
from damage.history import schema
from damage.wall.kinds import SIDE_COURSE

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
    codes = schema.codes_of(version)
    sizes, n_bytes, ended = {}, 0, True
    for path, column in schema.columns_of(version).items():
        group, _, name = path.partition("/")
        if path in schema.OPTIONAL and name not in file[group]:
            continue
        dataset = _dataset(file, path)
        _check_type(path, dataset, column, codes)
        _check_shape(path, dataset, schema.SHAPES.get(path, schema.SHAPES[group]), sizes, ended)
        n_bytes += _stored(path, dataset)
        if path == "run/status":
            ended = dataset[()] != 0
    for what in ("joints", "bodies", "supports"):
        if sizes.get(what) == 0:
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


_HUGE = 1e30
"""No quantity of a wall comes near this number of its unit."""
_UNITS = ("_s", "_g", "_m", "_pa")
"""With which the names of parameters end that are numbers."""


def check_parameters(parameters):
    """Raise InputError unless the parameters of a run consist of tables, numbers and text, as a run writes them."""
    optional = dict.fromkeys(("settlement", "cracked", "life", "event"), (dict, type(None)))
    kinds = optional | {"loading": dict, "wall": dict, "model": dict, "wall_file": dict, "sequence": list,
                        "events": list, "motions": list, "points": list, "stresses": bool}
    numbers = (float, int)
    if not isinstance(parameters, dict):
        raise InputError("its parameters are no table")
    for name, value in parameters.items():
        words = () if name.endswith(_UNITS) else (str,)
        if not isinstance(value, kinds.get(name, (*words, *numbers, type(None)))):
            wanted = "a number" if name.endswith(_UNITS) else "what a run writes there"
            raise InputError(f"parameter {name} is {value!r:.80}, expected {wanted}")
        if isinstance(value, numbers) and not abs(value) < _HUGE:
            raise InputError(f"parameter {name} is {value!r:.80}, expected a number that can be")
    for place in parameters.get("points", []):
        if not (isinstance(place, list) and len(place) == 2 and all(isinstance(one, numbers) for one in place)):
            raise InputError(f"parameter points is {place!r:.80}, expected places x, z")
    for factor in parameters.get("sequence", [1.0]) or [None]:
        check_number("a factor of parameter sequence", factor, "a number that can be", lambda value: abs(value) < _HUGE)
    _check_events(parameters)


def _check_events(parameters):
    motions, events = parameters.get("motions", []), parameters.get("events", [])
    known = all(isinstance(event, dict) and event.get("motion") in range(len(motions)) for event in events)
    if not known or not all(isinstance(motion, dict) for motion in motions) or (
            (motions or events) and len(events) != len(parameters.get("sequence", []))):
        raise InputError(f"parameters motions and events are {len(motions)} and {len(events)}, expected a motion for "
                         "each factor of parameter sequence")


def check_values(history):
    """Raise InputError for impossible values of a History: not finite, unknown joints, time that does not increase."""
    joints, bodies, events, series = history.joints, history.bodies, history.events, history.series
    for name, value in history.static.items():
        if abs(value) >= _HUGE:
            raise InputError(f"static/{name} is {value:g}, expected a number that can be")
    _check_columns("joints", joints, infinite=("tensile_strength_pa", "cohesion_pa"))
    _check_columns("bodies", bodies)
    _check_columns("events", events)
    _check_columns("static_stage", {} if history.static_stage is None else history.static_stage)
    # A column that a solver does not provide is empty: it has all its values or none.
    empty = [name for name, values in series.items() if values.dtype.kind == "f" and np.isnan(values.to_numpy()).all()
             and name not in ("time_s", "drift_ratio")]
    _check_columns("series", series.drop(columns=empty))
    for table, names in ((joints, ("length_m", "area_m2")), (bodies, ("length_m", "height_m", "mass_kg"))):
        for name in names:
            values = table[name].to_numpy()
            massless = name == "mass_kg" and bodies["course"].to_numpy() == SIDE_COURSE  # party walls
            _refuse(~(values > 0) & ~np.asarray(massless), name, "a number above zero", values)
    _check_points(history)
    n_supports = 1 if history.supports is None else len(history.supports)
    for table, name, least, end in ((joints, "first_body", -n_supports, len(bodies)),
                                    (joints, "second_body", 0, len(bodies)), (events, "joint", 0, len(joints))):
        values = table[name].to_numpy()
        _refuse((values < least) | (values >= end), name, f"{least} to {end - 1}", values)
    time_s = series["time_s"].to_numpy()
    _refuse(np.diff(time_s, prepend=-np.inf) <= 0, "time_s", "a later time than before", time_s)
    for name, frames in (*((name, getattr(history.active, name)) for name in ("opening_m", "slip_m", "offset_m")),
                         ("displacement", history.displacement), ("stress_pa", history.stress_pa),
                         ("joint_stress_pa", history.joint_stress_pa), ("points", history.point_displacement),
                         ("ground/displacement", history.support_displacement)):
        # Of the extremes first, which takes no memory: of what is no number both are none, too.
        if frames is None or (-_HUGE < frames.min(initial=0.0) and frames.max(initial=0.0) < _HUGE):
            continue
        fine = (np.abs(frames) < _HUGE).all(axis=tuple(range(1, frames.ndim)))
        if not fine.all():
            raise InputError(f"{name} is no number that can be in row {int(np.argmin(fine))}: its run "
                             "blew up, give it a smaller --dt")


def _check_points(history):
    """Raise InputError where the material points are not those of the parameters."""
    if history.point_displacement is not None and history.point_displacement.shape[1] != len(history.points):
        raise InputError(f"points/displacement is of {history.point_displacement.shape[1]} points, expected each of "
                         f"parameter points, {len(history.points)}")


def _check_columns(table, frame, infinite=()):
    """Raise InputError for numbers that are not finite; those of the columns `infinite` may be infinite."""
    for name, column in frame.items():
        if column.dtype.kind == "f":
            values = column.to_numpy()
            allowed = np.abs(values) < _HUGE
            if name in infinite:
                allowed |= values == np.inf
            _refuse(~allowed, f"{table}/{name}", "a number that can be", values)


def _refuse(wrong, name, expected, values):
    """Raise InputError that names the first row where `wrong`; both (n,)."""
    if wrong.any():
        row = int(np.argmax(wrong))
        raise InputError(f"{name} is {values[row]:g} in row {row}, expected {expected}")
