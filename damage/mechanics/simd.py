"""Widths of a step: one wall, or eight walls at once in the SIMD lanes of vectors with element-wise
arithmetic.

Tables are arrays (rows, fields, W) of float64, contiguous, the wall last.  The functions of a step
take a width `n` as first argument, and numba compiles them for its type: ONE and a `Lane`, a wall
of a table of eight, give single numbers, EIGHT gives vectors, and so does ROWS: of eight rows of a
table of one wall.

    x = load(n, table, row, field)                              # a number, or those of eight walls
    store(n, table, row, field, either(x > 0.0, 2.0 * x, 0.0))

numba has no type of vectors, and vectorizes loops only where it can prove that no arrays overlap.
Compiled, the type is a vector of LLVM, on any machine; where numba is switched off, it is a numpy
array.  Each operation is rounded by itself, so that every lane has the same bits as a single
number.  Where a register holds four numbers (AVX2), LLVM uses two registers for a vector.
"""

import operator
from functools import cached_property
from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import typeof, types
from numba.core import cgutils
from numba.extending import (
    lower_builtin,
    models,
    register_jitable,
    register_model,
    type_callable,
)

WIDTH = 8


def argument(kind):
    """A NamedTuple class for arguments of compiled functions: numba gets their type from
    themselves, found once.

    numba 0.56, which Debian 12 has, would read names of fields from freed memory, often not know a
    type again, and keep 800 bytes a call.  Without `_asdict` it asks for `_numba_type_` instead.
    """
    return type(
        kind.__name__,
        (kind,),
        {
            "__doc__": kind.__doc__,
            "__module__": kind.__module__,
            "_asdict": property(),
            "_numba_type_": cached_property(typeof),
        },
    )


@argument
class One(NamedTuple):
    """Width of a table of one wall."""

    lane: int


@argument
class Lane(NamedTuple):
    """A single wall, by its place, in a table of eight."""

    lane: int


@argument
class Eight(NamedTuple):
    """Width of a table of eight walls."""

    lane: int


@argument
class Rows(NamedTuple):
    """Eight rows of a table of one wall at once, from a row on."""

    lane: int


ONE = One(0)
EIGHT = Eight(0)
ROWS = Rows(0)


def is_wide(n):
    """Whether a width gives vectors."""
    return isinstance(n, (Eight, Rows))


def _part(n, table, row, field):
    return table[row, field] if isinstance(n, Eight) else table[row : row + WIDTH, field, 0]


def load(n, table, row, field):
    """A number, or a vector of those of all walls, or of all rows, of a table in the order of
    columns."""
    return np.copy(_part(n, table, row, field)) if is_wide(n) else table[row, field, n.lane]


def store(n, table, row, field, value):
    """Write a number, or a vector."""
    if is_wide(n):
        _part(n, table, row, field)[:] = value
    else:
        table[row, field, n.lane] = value


@register_jitable
def add(n, table, row, field, value):
    """Add a number, or a vector, to what the table has."""
    store(n, table, row, field, load(n, table, row, field) + value)


@register_jitable
def store_where(n, table, row, field, which, value):
    """Write a number where the flag `which` is set, or those of a vector where its flags are."""
    store(n, table, row, field, either(which, value, load(n, table, row, field)))


@register_jitable
def of_each(n, table, row, field):
    """Numbers of each wall as by `load`, also from a table of one wall that all walls share."""
    if table.shape[2] == 1:
        return filled(n, table[row, field, 0])
    return load(n, table, row, field)


def filled(n, value):
    """A number in all lanes of a width; compiled, also the numbers of a NamedTuple."""
    return np.full(WIDTH, value) if is_wide(n) else value


@register_jitable
def zero(n):
    """The number zero, or a vector of zeros."""
    return filled(n, 0.0)


def flags_of(n, whole):
    """Flags from the lowest bits of an integer: of one wall a bool, of eight a vector."""
    return np.array([whole >> w & 1 > 0 for w in range(WIDTH)]) if is_wide(n) else whole & 1 > 0


def bits(flags):
    """Flags, a vector or a bool, as bits of an integer, the first flag as the lowest bit."""
    return (
        sum(1 << w for w, flag in enumerate(flags) if flag)
        if isinstance(flags, np.ndarray)
        else int(flags)
    )


def lanes(n):
    """How many numbers the width gives."""
    return WIDTH if is_wide(n) else 1


def widest(n):
    """The width that gives vectors of the same table."""
    return n if is_wide(n) else ROWS


def table_width(n):
    """The width of the whole table, of a row at a time."""
    return ONE if isinstance(n, Rows) else n


def rows_of(n):
    """How many rows the width takes."""
    return WIDTH if isinstance(n, Rows) else 1


def in_blocks(n, row):
    """The width by which `row`, as of `rows_of` a width, is read from a table whose last axis is
    eight rows."""
    return EIGHT if isinstance(n, Rows) else Lane(row % WIDTH)


def four(n, table, rows, k, field):
    """Four fields from `field` on of row rows[k], or as vectors those of rows[k] to rows[k + WIDTH
    - 1]."""
    if isinstance(n, Rows):
        return tuple(table[rows[k : k + WIDTH], field + i, 0] for i in range(4))
    return tuple(load(n, table, rows[k], field + i) for i in range(4))


def put_four(n, table, rows, k, field, values):
    """Write four values into the fields that `four` gives."""
    for i, value in enumerate(values):
        if isinstance(n, Rows):
            table[rows[k : k + WIDTH], field + i, 0] = value
        else:
            store(n, table, rows[k], field + i, value)


def add_three(n, table, first, second, k, field, to_first, to_second):
    """Add three values to fields from `field` on of row first[k], and three to those of second[k];
    of ROWS also of the rows that follow, one pair after the other, since pairs may share rows, and
    zero to the field before."""
    for j in range(rows_of(n)):
        for rows, values in ((first, to_first), (second, to_second)):
            for i, value in enumerate(values):
                table[rows[k + j], field + i] += value if isinstance(n, Eight) else value[j]


def add_part(n, sums, kind, row, value):
    """Add a value of `row`, or of eight rows from it on, to its partial sum: rows 0, 8, 16 and so
    on have the first, rows 1, 9, 17 and so on the second; sums: (kinds, WIDTH, W)."""
    if isinstance(n, Rows):
        sums[kind, :, 0] += value
    else:
        add(n, sums, kind, row % WIDTH, value)


def wall_of(n, w):
    """The width of wall w by itself; of the one wall of ROWS."""
    return Lane(w) if isinstance(n, Eight) else ONE if isinstance(n, Rows) else n


def lane(value, w):
    """The number of wall w; a single number itself."""
    return value[w] if isinstance(value, np.ndarray) else value


def with_lane(value, w, number):
    """The vector with another number for wall w; in place of a single number the other one."""
    if not isinstance(value, np.ndarray):
        return number
    return np.where(np.arange(WIDTH) == w, number, value)


def either(condition, x, y):
    """x where the condition holds, else y; for vectors and for single numbers."""
    return (
        np.where(condition, x, y) if isinstance(condition, np.ndarray) else (x if condition else y)
    )


class Vector(types.Type):
    """numba's type of a vector of WIDTH numbers, or of WIDTH flags."""


NUMBERS = Vector(f"{WIDTH} numbers")
FLAGS = Vector(f"{WIDTH} flags")
_INT = ir.IntType(32)
_LONG = ir.IntType(64)
_REAL = ir.DoubleType()
_FLAG = ir.IntType(1)
_VECTORS = {NUMBERS: ir.VectorType(_REAL, WIDTH), FLAGS: ir.VectorType(_FLAG, WIDTH)}
_FOUR = ir.VectorType(_REAL, 4)


@register_model(Vector)
class _Model(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, _VECTORS[kind])


def _is_wide(n):
    return n.instance_class in (Eight, Rows)


def _width(kind):
    return types.NamedUniTuple(types.intp, 1, kind)


def _numbers(n):
    """Type of what a width gives."""
    return NUMBERS if _is_wide(n) else types.float64


def _is_number(kind):
    return kind == NUMBERS or isinstance(kind, types.Float)


def _mixed(builder, x, y, order):
    """A vector of the elements `order` of two."""
    return builder.shuffle_vector(x, y, ir.Constant(ir.VectorType(_INT, len(order)), order))


def _spread(builder, kind, value):
    """A vector from a value of this type: the vector itself, or one number in all lanes."""
    if kind == NUMBERS:
        return value
    none = ir.Constant(_VECTORS[NUMBERS], ir.Undefined)
    return _mixed(builder, builder.insert_element(none, value, _INT(0)), none, [0] * WIDTH)


# --- operations -----------------------------------------------------------------------------------


def _operation(function, typer, make, *operands):
    """Register an operation; typer: the type of its result from those of its operands, or None;
    make: its LLVM instruction from the builder and vectors; operands: types of them that it
    takes."""
    type_callable(function)(lambda _context: typer)

    def lower(_context, builder, signature, values):
        return make(
            builder,
            *(
                value if kind == FLAGS else _spread(builder, kind, value)
                for kind, value in zip(signature.args, values)
            ),
        )

    for kinds in operands:
        lower_builtin(function, *kinds)(lower)


def _binary(function, result, make):
    """Register an operation on two vectors of numbers, or on a vector and a number."""
    _operation(
        function,
        lambda x, y: result if NUMBERS in (x, y) and _is_number(x) and _is_number(y) else None,
        make,
        (NUMBERS, NUMBERS),
        (NUMBERS, types.Float),
        (types.Float, NUMBERS),
    )


def _comparison(sign):
    return lambda builder, x, y: builder.fcmp_ordered(sign, x, y)


def _without_sign(builder, x):
    longs = ir.VectorType(_LONG, WIDTH)
    return builder.bitcast(
        builder.and_(builder.bitcast(x, longs), ir.Constant(longs, [2**63 - 1] * WIDTH)),
        _VECTORS[NUMBERS],
    )


for _function, _make in (
    (operator.add, ir.IRBuilder.fadd),
    (operator.sub, ir.IRBuilder.fsub),
    (operator.mul, ir.IRBuilder.fmul),
    (operator.truediv, ir.IRBuilder.fdiv),
):
    _binary(_function, NUMBERS, _make)
for _function, _sign in (
    (operator.gt, ">"),
    (operator.ge, ">="),
    (operator.lt, "<"),
    (operator.le, "<="),
    (operator.eq, "=="),
):
    _binary(_function, FLAGS, _comparison(_sign))
for _function, _make in ((operator.and_, ir.IRBuilder.and_), (operator.or_, ir.IRBuilder.or_)):
    _operation(_function, lambda x, y: FLAGS if x == y == FLAGS else None, _make, (FLAGS, FLAGS))
for _function, _make in ((operator.neg, ir.IRBuilder.fneg), (abs, _without_sign)):
    _operation(_function, lambda x: NUMBERS if x == NUMBERS else None, _make, (NUMBERS,))


# --- the functions above --------------------------------------------------------------------------


def _compiles(function, typer):
    """Decorator of what writes the LLVM code of a call of this function; typer: the type of its
    result from those of its arguments."""
    type_callable(function)(lambda _context: typer)
    return lower_builtin(function, types.VarArg(types.Any))


@_compiles(bits, lambda flags: types.intp)
def _bits(_context, builder, signature, values):
    (flags,) = values
    return builder.zext(
        builder.bitcast(flags, ir.IntType(WIDTH)) if signature.args[0] == FLAGS else flags, _LONG
    )


@_compiles(flags_of, lambda n, whole: FLAGS if _is_wide(n) else types.boolean)
def _flags_of(_context, builder, signature, values):
    if _is_wide(signature.args[0]):
        return builder.bitcast(builder.trunc(values[1], ir.IntType(WIDTH)), _VECTORS[FLAGS])
    return builder.trunc(values[1], _FLAG)


def _filled_type(n, value):
    if isinstance(value, types.BaseTuple):
        return types.BaseTuple.from_types([_numbers(n)] * len(value), value.instance_class)
    return _numbers(n)


@_compiles(filled, _filled_type)
def _filled(context, builder, signature, values):
    n, kind = signature.args
    if not isinstance(kind, types.BaseTuple):
        return _value(context, builder, n, kind, values[1])
    numbers = cgutils.unpack_tuple(builder, values[1])
    parts = [_value(context, builder, n, field, number) for field, number in zip(kind, numbers)]
    return context.make_tuple(builder, signature.return_type, parts)


@_compiles(lanes, lambda n: types.intp)
def _lanes(_context, builder, signature, values):
    return _LONG(WIDTH if _is_wide(signature.args[0]) else 1)


@_compiles(rows_of, lambda n: types.intp)
def _rows_of(_context, _builder, signature, values):
    return _LONG(WIDTH if signature.args[0].instance_class is Rows else 1)


@_compiles(table_width, lambda n: _width(One) if n.instance_class is Rows else n)
@_compiles(widest, lambda n: n if _is_wide(n) else _width(Rows))
def _same(_context, _builder, _signature, values):
    return values[0]


@_compiles(wall_of, lambda n, w: {Eight: _width(Lane), Rows: _width(One)}.get(n.instance_class, n))
def _wall_of(context, builder, signature, values):
    if signature.args[0].instance_class is not Eight:
        return values[0]
    return context.make_tuple(
        builder,
        signature.return_type,
        [context.cast(builder, values[1], signature.args[1], types.intp)],
    )


@_compiles(in_blocks, lambda n, row: _width(Eight if n.instance_class is Rows else Lane))
def _in_blocks(context, builder, signature, values):
    row = context.cast(builder, values[1], signature.args[1], types.intp)
    return context.make_tuple(builder, signature.return_type, [builder.and_(row, _LONG(WIDTH - 1))])


@_compiles(lane, lambda value, w: types.float64)
def _lane(_context, builder, signature, values):
    return builder.extract_element(*values) if signature.args[0] == NUMBERS else values[0]


@_compiles(with_lane, lambda value, w, number: value)
def _with_lane(_context, builder, signature, values):
    value, w, number = values
    return builder.insert_element(value, number, w) if signature.args[0] == NUMBERS else number


@_compiles(
    either, lambda condition, x, y: NUMBERS if NUMBERS in (x, y) or condition == FLAGS else x
)
def _either(_context, builder, signature, values):
    condition, x, y = values
    if signature.return_type == NUMBERS:
        x, y = (_spread(builder, kind, value) for kind, value in zip(signature.args[1:], (x, y)))
    return builder.select(condition, x, y)


def _whole(context, builder, signature, values, k):
    """Argument number k of a call, a whole number, as one of numba's size."""
    return context.cast(builder, values[k], signature.args[k], types.intp)


def _pointer(context, builder, signature, values, row=None, field=None, single=False):
    """LLVM pointer to the number or vector of a table in a call (n, table, row, field, ...); fields
    of the table follow one another by its width.

    row, field: others, as `_whole`; single: to the number of a table of one wall.
    """
    kind = signature.args[1]
    n = One if single else signature.args[0].instance_class
    row = _whole(context, builder, signature, values, 2) if row is None else row
    field = _whole(context, builder, signature, values, 3) if field is None else field
    array = context.make_array(kind)(context, builder, values[1])
    by_rows, by_fields = cgutils.unpack_tuple(builder, array.strides)[:2]
    if kind.layout == "F":
        by_rows = _LONG(8)
    else:
        by_fields = _LONG(8 * (1 if n in (One, Rows) else WIDTH))
    place = builder.add(builder.mul(row, by_rows), builder.mul(field, by_fields))
    if n is Lane:
        place = builder.add(place, builder.mul(builder.extract_value(values[0], 0), _LONG(8)))
    pointer = builder.gep(builder.bitcast(array.data, ir.IntType(8).as_pointer()), [place])
    kind = _VECTORS[NUMBERS] if n in (Eight, Rows) else _REAL
    return builder.bitcast(pointer, kind.as_pointer())


def _value(context, builder, n, kind, value):
    """A value to write, of this type, in the width of the table."""
    if _is_wide(n):
        return _spread(builder, kind, value)
    return context.cast(builder, value, kind, types.float64)


@_compiles(load, lambda n, table, row, field: _numbers(n))
def _load(context, builder, signature, values):
    return builder.load(_pointer(context, builder, signature, values), align=8)


@_compiles(store, lambda n, table, row, field, value: types.none)
def _store(context, builder, signature, values):
    value = _value(context, builder, signature.args[0], signature.args[4], values[4])
    builder.store(value, _pointer(context, builder, signature, values), align=8)
    return context.get_dummy_value()


@_compiles(add_part, lambda n, sums, kind, row, value: types.none)
def _add_part(context, builder, signature, values):
    n = signature.args[0]
    part = _LONG(0)
    single = n.instance_class is Rows
    if not single:
        part = builder.and_(_whole(context, builder, signature, values, 3), _LONG(WIDTH - 1))
    pointer = _pointer(context, builder, signature, values, field=part, single=single)
    value = _value(context, builder, n, signature.args[4], values[4])
    pointer = builder.bitcast(pointer, value.type.as_pointer())
    builder.store(builder.fadd(builder.load(pointer, align=8), value), pointer, align=8)
    return context.get_dummy_value()


# --- four fields of rows that an array names ------------------------------------------------------

# Shuffles of two vectors: their even elements alternately, and their odd elements.
_EVEN, _ODD = (
    [k + start for pair in range(0, WIDTH, 2) for start in (pair, WIDTH + pair)] for k in (0, 1)
)
# Shuffles of two vectors of pairs: the first pairs of each four alternately, and the second pairs.
_FRONT, _BACK = (
    [four + k + i for four in range(0, WIDTH, 4) for k in (pair, WIDTH + pair) for i in (0, 1)]
    for pair in (0, 2)
)
_FOURS = [list(range(four, four + 4)) for four in range(0, WIDTH, 4)]


def _as_rows(builder, a, b, c, d):
    """WIDTH rows of four numbers from four vectors: in registers, which is faster than number by
    number."""
    low = [_mixed(builder, a, b, order) for order in (_EVEN, _ODD)]
    high = [_mixed(builder, c, d, order) for order in (_EVEN, _ODD)]
    both = [_mixed(builder, low[k % 2], high[k % 2], _BACK if k > 1 else _FRONT) for k in range(4)]
    return [_mixed(builder, pair, pair, four) for four in _FOURS for pair in both]


def _as_columns(builder, rows):
    """Four vectors from WIDTH rows of four numbers."""
    both = [_mixed(builder, rows[k], rows[k + 4], list(range(8))) for k in range(4)]
    low = [_mixed(builder, both[0], both[1], order) for order in (_EVEN, _ODD)]
    high = [_mixed(builder, both[2], both[3], order) for order in (_EVEN, _ODD)]
    return [_mixed(builder, low[k % 2], high[k % 2], _BACK if k > 1 else _FRONT) for k in range(4)]


def _named(context, builder, signature, values, rows):
    """Pointers to the first of four fields of each row that argument number `rows` names, an array
    of uint32."""
    places = context.make_array(signature.args[rows])(context, builder, values[rows]).data
    single = signature.args[0].instance_class is Rows
    (k, field) = (
        _whole(context, builder, signature, values, i)
        for i in ((4, 5) if len(values) == 8 else (3, 4))
    )
    for i in range(WIDTH if single else 1):
        row = builder.load(builder.gep(places, [builder.add(k, _LONG(i))]))
        row = builder.zext(row, _LONG)
        yield _pointer(context, builder, signature, values, row=row, field=field, single=single)


@_compiles(four, lambda n, table, rows, k, field: types.UniTuple(_numbers(n), 4))
def _four(context, builder, signature, values):
    pointers = [*_named(context, builder, signature, values, 2)]
    if signature.args[0].instance_class is not Rows:
        loaded = [builder.load(builder.gep(pointers[0], [_INT(i)]), align=8) for i in range(4)]
    else:
        loaded = _as_columns(
            builder,
            [
                builder.load(builder.bitcast(pointer, _FOUR.as_pointer()), align=8)
                for pointer in pointers
            ],
        )
    return context.make_tuple(builder, signature.return_type, loaded)


@_compiles(put_four, lambda n, table, rows, k, field, values: types.none)
def _put_four(context, builder, signature, values):
    pointers = [*_named(context, builder, signature, values, 2)]
    four_of = [builder.extract_value(values[5], i) for i in range(4)]
    if signature.args[0].instance_class is not Rows:
        pairs = [(value, builder.gep(pointers[0], [_INT(i)])) for i, value in enumerate(four_of)]
    else:
        pairs = zip(
            _as_rows(builder, *four_of),
            [builder.bitcast(pointer, _FOUR.as_pointer()) for pointer in pointers],
        )
    for value, place in pairs:
        builder.store(value, place, align=8)
    return context.get_dummy_value()


def _added(context, builder, signature, values, rows, three):
    """Pointers and what to add there, for one of both sets of rows of `add_three`."""
    pointers = [*_named(context, builder, signature, values, rows)]
    three = [builder.extract_value(three, i) for i in range(3)]
    if signature.args[0].instance_class is not Rows:
        return [(builder.gep(pointers[0], [_INT(i)]), value) for i, value in enumerate(three)]
    before = [
        builder.bitcast(builder.gep(pointer, [_INT(-1)]), _FOUR.as_pointer())
        for pointer in pointers
    ]
    return zip(before, _as_rows(builder, ir.Constant(_VECTORS[NUMBERS], [0.0] * WIDTH), *three))


@_compiles(add_three, lambda n, table, first, second, k, field, to_first, to_second: types.none)
def _add_three(context, builder, signature, values):
    both = [
        _added(context, builder, signature, values, rows=rows, three=three)
        for rows, three in ((2, values[6]), (3, values[7]))
    ]
    pairs = [component for pair in zip(*both) for component in pair]
    for place, value in pairs:
        builder.store(builder.fadd(builder.load(place, align=8), value), place, align=8)
    return context.get_dummy_value()


# --- records --------------------------------------------------------------------------------------


def reader(kind, names, prefix=""):
    """A function (n, table, row) that returns a row as NamedTuple `kind`, of numbers or of vectors,
    flags as bool.

    names: of the table's fields; prefix: of those of the NamedTuple.  A new field needs no change
    here.
    """
    places = [names.index(prefix + name) for name in kind._fields]
    are_flags = [kind.__annotations__[name] is bool for name in kind._fields]

    def read(n, table, row):
        return kind(
            *(
                load(n, table, row, place) > 0.0 if is_flag else load(n, table, row, place)
                for place, is_flag in zip(places, are_flags)
            )
        )

    @_compiles(
        read,
        lambda n, table, row: types.BaseTuple.from_types(
            [types.boolean if is_flag else _numbers(n) for is_flag in are_flags], kind
        ),
    )
    def _read_all(context, builder, signature, values):
        loaded = _fields(context, builder, signature, values, places)
        return context.make_tuple(
            builder,
            signature.return_type,
            [
                builder.fcmp_ordered(">", value, _REAL(0.0)) if is_flag else value
                for value, is_flag in zip(loaded, are_flags)
            ],
        )

    return read


def writer(kind, names, prefix=""):
    """A function (n, table, row, which, record) that writes a NamedTuple `kind` into a row where
    the flags `which` are set; arguments as of `reader`."""
    places = [names.index(prefix + name) for name in kind._fields]

    def keep(n, table, row, which, record):
        for place, value in zip(places, record):
            store_where(n, table, row, place, which, value)

    @_compiles(keep, lambda n, table, row, which, record: types.none)
    def _keep(context, builder, signature, values):
        # All are read before the first one is written, so that vectors need not wait.
        old = _fields(context, builder, signature, values, places)
        for k, (place, before, kind) in enumerate(zip(places, old, signature.args[4])):
            value = builder.extract_value(values[4], k)
            value = _value(context, builder, signature.args[0], kind, value)
            pointer = _pointer(context, builder, signature, values, field=_LONG(place))
            builder.store(builder.select(values[3], value, before), pointer, align=8)
        return context.get_dummy_value()

    return keep


def _fields(context, builder, signature, values, places):
    """What a row has in these fields; the first three arguments: n, table, row."""
    pointers = (
        _pointer(context, builder, signature, values, field=_LONG(place)) for place in places
    )
    return [builder.load(pointer, align=8) for pointer in pointers]


def column(first, apart):
    """A function (n, table, row, k) that loads the field `first` + k `apart`."""

    @register_jitable
    def read(n, table, row, k):
        return load(n, table, row, first + k * apart)

    return read
