"""Transposition of WIDTH scattered rows of four numbers into four vectors, and back.

It takes place in the registers of the processor, which is faster than to load each number by itself.

    x, z, cos1, sin = rows_of(bodies, places, i, 0)      # of the rows at places[i] to places[i + WIDTH - 1]
    set_rows(bodies, places, i, 4, x, z, cos1, sin)      # writes them four numbers further on
    add_rows(bodies, first, second, i, 4, (x, z, moment), (x, z, other_moment))
"""

from llvmlite import ir
from numba import types
from numba.extending import lower_builtin

from damage.mechanics.eight import NUMBERS, WIDTH, teach_type

# Shuffles of two vectors: their even elements alternately, and their odd elements.
_EVEN, _ODD = ([k + of for pair in range(0, WIDTH, 2) for of in (pair, WIDTH + pair)] for k in (0, 1))
# Shuffles of two vectors of pairs: the first pairs of each four alternately, and the second pairs.
_FRONT, _BACK = ([four + k + i for four in range(0, WIDTH, 4) for k in (pair, WIDTH + pair) for i in (0, 1)]
                 for pair in (0, 2))
_FOURS = [list(range(four, four + 4)) for four in range(0, WIDTH, 4)]
_INT, _LONG = ir.IntType(32), ir.IntType(64)
_ROW, _VALUE = ir.VectorType(ir.DoubleType(), 4), ir.VectorType(ir.DoubleType(), WIDTH)


def rows_of(array, places, i, offset):
    """Four vectors: the numbers from `offset` on of the rows that begin at places[i] to places[i + WIDTH - 1]."""
    return tuple(array[places[i:i + WIDTH] + offset + k] for k in range(4))


def set_rows(array, places, i, offset, a, b, c, d):
    """Write four vectors into the rows from which `rows_of` reads them."""
    for k, eight in enumerate((a, b, c, d)):
        array[places[i:i + WIDTH] + offset + k] = eight


def add_rows(array, first, second, i, offset, to_first, to_second):
    """Add three vectors to each of two sets of rows, one pair of rows after the other, since pairs may share rows."""
    for k in range(WIDTH):
        for places, eights in ((first, to_first), (second, to_second)):
            for n, eight in enumerate(eights):
                array[places[i + k] + offset + n] += eight[k]


_THREE = types.UniTuple(NUMBERS, 3)
teach_type(rows_of, lambda array, places, i, offset: types.UniTuple(NUMBERS, 4))
teach_type(set_rows, lambda array, places, i, offset, a, b, c, d: types.none)
teach_type(add_rows, lambda array, first, second, i, offset, to_first, to_second: types.none)


def _mixed(builder, x, y, order):
    return builder.shuffle_vector(x, y, ir.Constant(ir.VectorType(_INT, len(order)), order))


def _as_rows(builder, a, b, c, d):
    """WIDTH rows of four numbers from four vectors."""
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


def _pointers(context, builder, signature, array, places, i, offset):
    """LLVM pointers to the rows."""
    kinds = signature.args
    numbers = context.make_array(kinds[0])(context, builder, array).data
    wheres = context.make_array(kinds[1])(context, builder, places).data
    for k in range(WIDTH):
        where = builder.load(builder.gep(wheres, [builder.add(i, i.type(k))]))
        yield builder.bitcast(builder.gep(numbers, [builder.add(where, offset)]), _ROW.as_pointer())


@lower_builtin(rows_of, types.Array, types.Array, types.Integer, types.Integer)
def _rows_of(context, builder, signature, values):
    rows = [builder.load(pointer, align=8) for pointer in _pointers(context, builder, signature, *values)]
    return context.make_tuple(builder, signature.return_type, _as_columns(builder, rows))


@lower_builtin(set_rows, types.Array, types.Array, types.Integer, types.Integer, *[NUMBERS] * 4)
def _set_rows(context, builder, signature, values):
    for row, pointer in zip(_as_rows(builder, *values[4:]), _pointers(context, builder, signature, *values[:4])):
        builder.store(row, pointer, align=8)
    return context.get_dummy_value()


@lower_builtin(add_rows, types.Array, types.Array, types.Array, types.Integer, types.Integer, _THREE, _THREE)
def _add_rows(context, builder, signature, values):
    array, first, second, i, offset, *added = values
    none = ir.Constant(_VALUE, [0.0] * WIDTH)
    rows = [_as_rows(builder, *(builder.extract_value(three, k) for k in range(3)), none) for three in added]
    pointers = [_pointers(context, builder, signature, array, places, i, offset) for places in (first, second)]
    for row, other, *pair in zip(*rows, *pointers):
        for one, pointer in zip((row, other), pair):
            builder.store(builder.fadd(builder.load(pointer, align=8), one), pointer, align=8)
    return context.get_dummy_value()
