"""Vectors of eight float64 numbers with element-wise arithmetic, compiled to SIMD instructions.

A *SIMD lane* is the place of one number in such a vector.

    x = load(array, i)                                   # array[i] to array[i + 7]
    store(array, i, either(x > 0.0, 2.0 * x, 0.0))

numba has no such type, and vectorizes loops only where it can prove that no arrays overlap.  Compiled, the type is a
vector of LLVM, on any machine; where numba is switched off, it is a numpy array.  Each operation is rounded by itself,
so that every SIMD lane has the same bits as a single number.

Where a register holds four numbers (AVX2), LLVM uses two registers for a vector.
"""

import operator

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import lower_builtin, models, register_model, type_callable

WIDTH = 8


def load(array, i):
    """Vector of the WIDTH elements of an array from index i on."""
    return array[i:i + WIDTH].copy()


def store(array, i, eight):
    """Write a vector, or one number WIDTH times, into an array from index i on."""
    array[i:i + WIDTH] = eight


def add(array, i, eight):
    """Add a vector to the WIDTH elements of an array from index i on."""
    array[i:i + WIDTH] += eight


def either(condition, x, y):
    """x where the condition holds, else y; for vectors and for single numbers."""
    return np.where(condition, x, y) if isinstance(condition, np.ndarray) else (x if condition else y)


def bits(flags):
    """The WIDTH flags of a vector as bits of an integer, the first flag as the lowest bit."""
    return int(np.packbits(flags, bitorder="little")[0])


def flags_of(whole):
    """Vector of WIDTH flags from the lowest bits of an integer."""
    return np.unpackbits(np.uint8([whole & 255]), bitorder="little")[:WIDTH].astype(bool)


def spread(number):
    """Vector of one number WIDTH times."""
    return np.full(WIDTH, number)


class Eight(types.Type):
    """numba's type of a vector of WIDTH numbers, or of WIDTH flags."""


NUMBERS, FLAGS = Eight(f"{WIDTH} numbers"), Eight(f"{WIDTH} flags")
_INT, _LONG, _REAL, _FLAG = ir.IntType(32), ir.IntType(64), ir.DoubleType(), ir.IntType(1)
_VECTORS = {NUMBERS: ir.VectorType(_REAL, WIDTH), FLAGS: ir.VectorType(_FLAG, WIDTH)}


@register_model(Eight)
class _Model(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, _VECTORS[kind])


def _spread(builder, kind, value):
    """A vector from a value of this type: the vector itself, or one number in all SIMD lanes."""
    if kind == NUMBERS:
        return value
    none = ir.Constant(_VECTORS[NUMBERS], ir.Undefined)
    return builder.shuffle_vector(builder.insert_element(none, value, _INT(0)), none,
                                  ir.Constant(ir.VectorType(_INT, WIDTH), [0] * WIDTH))


def teach_type(function, typer):
    """Register a function with numba; typer: the type of its result from those of its arguments, or None."""
    type_callable(function)(lambda _context: typer)


def _is_number(kind):
    return kind == NUMBERS or isinstance(kind, types.Float)


def _teach_binary(function, result, make):
    """Register an operation on two vectors, or on a vector and a number; make: its LLVM instruction."""
    teach_type(function, lambda x, y: result if NUMBERS in (x, y) and _is_number(x) and _is_number(y) else None)

    def lower(_context, builder, signature, values):
        return make(builder, *(_spread(builder, kind, value) for kind, value in zip(signature.args, values)))

    for kinds in ((NUMBERS, NUMBERS), (NUMBERS, types.Float), (types.Float, NUMBERS)):
        lower_builtin(function, *kinds)(lower)


def _comparison(sign):
    return lambda builder, x, y: builder.fcmp_ordered(sign, x, y)


for _function, _make in ((operator.add, ir.IRBuilder.fadd), (operator.sub, ir.IRBuilder.fsub),
                         (operator.mul, ir.IRBuilder.fmul), (operator.truediv, ir.IRBuilder.fdiv)):
    _teach_binary(_function, NUMBERS, _make)
for _function, _sign in ((operator.gt, ">"), (operator.ge, ">="), (operator.lt, "<"), (operator.le, "<="),
                         (operator.eq, "==")):
    _teach_binary(_function, FLAGS, _comparison(_sign))
for _function in (operator.and_, operator.or_):
    teach_type(_function, lambda x, y: FLAGS if x == y == FLAGS else None)
for _function in (operator.neg, abs):
    teach_type(_function, lambda x: NUMBERS if x == NUMBERS else None)
teach_type(bits, lambda flags: types.uint8)
teach_type(flags_of, lambda whole: FLAGS)
teach_type(spread, lambda number: NUMBERS)
teach_type(load, lambda array, i: NUMBERS)
teach_type(store, lambda array, i, eight: types.none)
teach_type(add, lambda array, i, eight: types.none)
teach_type(either, lambda condition, x, y: NUMBERS if NUMBERS in (x, y) or condition == FLAGS else x)


@lower_builtin(operator.and_, FLAGS, FLAGS)
def _and(_context, builder, _signature, values):
    return builder.and_(*values)


@lower_builtin(operator.or_, FLAGS, FLAGS)
def _or(_context, builder, _signature, values):
    return builder.or_(*values)


@lower_builtin(operator.neg, NUMBERS)
def _neg(_context, builder, _signature, values):
    return builder.fneg(values[0])


@lower_builtin(abs, NUMBERS)
def _abs(_context, builder, _signature, values):
    longs = ir.VectorType(_LONG, WIDTH)
    without_sign = ir.Constant(longs, [2**63 - 1] * WIDTH)
    return builder.bitcast(builder.and_(builder.bitcast(values[0], longs), without_sign), _VECTORS[NUMBERS])


@lower_builtin(bits, FLAGS)
def _bits(_context, builder, _signature, values):
    return builder.bitcast(values[0], ir.IntType(WIDTH))


@lower_builtin(flags_of, types.Integer)
def _flags_of(_context, builder, _signature, values):
    return builder.bitcast(builder.trunc(values[0], ir.IntType(WIDTH)), _VECTORS[FLAGS])


@lower_builtin(spread, types.Float)
def _spread_one(_context, builder, signature, values):
    return _spread(builder, signature.args[0], values[0])


@lower_builtin(either, FLAGS, types.Any, types.Any)
@lower_builtin(either, types.Boolean, types.Any, types.Any)
def _choose(_context, builder, signature, values):
    condition, x, y = values
    if signature.return_type == NUMBERS:
        x, y = (_spread(builder, kind, value) for kind, value in zip(signature.args[1:], (x, y)))
    return builder.select(condition, x, y)


def _pointer(context, builder, kind, array, i):
    """LLVM pointer to the vector of an array from index i on."""
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [i]), _VECTORS[NUMBERS].as_pointer())


@lower_builtin(load, types.Array, types.Integer)
def _load(context, builder, signature, values):
    return builder.load(_pointer(context, builder, signature.args[0], *values), align=8)


@lower_builtin(store, types.Array, types.Integer, NUMBERS)
@lower_builtin(store, types.Array, types.Integer, types.Float)
def _store(context, builder, signature, values):
    array, i, value = values
    builder.store(_spread(builder, signature.args[2], value),
                  _pointer(context, builder, signature.args[0], array, i), align=8)
    return context.get_dummy_value()


@lower_builtin(add, types.Array, types.Integer, NUMBERS)
def _add(context, builder, signature, values):
    array, i, value = values
    pointer = _pointer(context, builder, signature.args[0], array, i)
    builder.store(builder.fadd(builder.load(pointer, align=8), value), pointer, align=8)
    return context.get_dummy_value()
