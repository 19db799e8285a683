"""Random numbers with the same bits on every machine and under every version of numpy.

numpy guarantees the bits of a seeded PCG64 (NEP 19), not what its Generator makes of them.  The
transforms here are those of numpy 1.17 to 2.4, so that seeds keep their draws: uniform numbers of
53 bits, whole numbers by the method of D. Lemire (2019), ACM Trans. Model. Comput. Simul. 29(1), 3,
normal numbers by the ziggurat of G. Marsaglia and W. W. Tsang (2000), J. Stat. Softw. 5(8).
"""

import math

import numpy as np

from damage.elementary import exp, log

_LAYERS = 256
"""Number of layers of the ziggurat."""
_EDGE = 3.6541528853610087963519472518
"""Place where the tail of the ziggurat begins, in standard deviations."""
_AREA = 0.00492867323397465524494
"""Area of a layer of the ziggurat."""
_MANTISSA = 2.0**52
_LOW = np.uint64(0xFFFFFFFF)
_HALF = np.uint64(32)


class Draws:
    """A stream of random numbers by a seed, an integer or a sequence of integers as of
    numpy.random.SeedSequence."""

    def __init__(self, seed):
        self._bits = np.random.PCG64(seed)
        self._half = np.zeros(0, np.uint64)

    def uniform(self, n):
        """Numbers (n,) from 0 to 1, below 1."""
        return (self._bits.random_raw(n) >> np.uint64(11)).astype(float) * 2.0**-53

    def below(self, number, n):
        """Whole numbers (n,) from 0 to number - 1, of a number up to 2**32."""
        numbers = np.zeros(n if number == 1 else 0, np.uint64)
        while len(numbers) < n:
            product = self._of_32_bits(n - len(numbers)) * np.uint64(number)
            numbers = np.append(
                numbers, product[product & _LOW >= np.uint64((2**32 - number) % number)] >> _HALF
            )
        return numbers.astype(np.int64)

    def normal(self, n):
        """Numbers (n,) of mean 0 and standard deviation 1."""
        return np.array([self._normal() for _ in range(n)])

    def _normal(self):
        while True:
            word = self._bits.random_raw()
            layer = word & 0xFF
            size = word >> 9 & 0xFFFFFFFFFFFFF
            negative = word >> 8 & 1
            x = size * _WIDTHS[layer]
            if size >= _WHOLE[layer]:  # at the edge of its layer
                if layer == 0:
                    return self._tail(size >> 8 & 1)
                above = _HEIGHTS[layer - 1]
                below = _HEIGHTS[layer]
                (up,) = self.uniform(1)
                if (above - below) * up + below >= exp(-0.5 * x * x):
                    continue
            return -x if negative else x

    def _of_32_bits(self, n):
        """Numbers (n,) of the lower, then the upper halves of words of 64 bits; the half that is
        left over is the first of the next call."""
        bits = self._bits.random_raw((n - len(self._half) + 1) // 2)
        halves = np.concatenate([self._half, np.column_stack([bits & _LOW, bits >> _HALF]).ravel()])
        self._half = halves[n:]
        return halves[:n]

    def _tail(self, negative):
        while True:
            across, up = (-float(log(1.0 - value)) for value in self.uniform(2))
            across /= _EDGE
            if 2.0 * up > across * across:
                return -(_EDGE + across) if negative else _EDGE + across


def _ziggurat():
    """Arrays of the layers: width over 2**52, the size below which a point is inside the next
    layer, too, and the density exp(-x^2 / 2) at the width.  Layer 0 is the base with the tail, the
    others grow from the top down."""
    width = [_EDGE]
    density = [float(exp(-0.5 * _EDGE * _EDGE))]
    while len(width) < _LAYERS - 1:
        density.append(density[-1] + _AREA / width[-1])
        width.append(math.sqrt(-2.0 * float(log(density[-1]))))
    width = [_AREA / density[0], *reversed(width)]
    density = [1.0, *reversed(density)]
    inner = [_EDGE, 0.0, *width[1:-1]]
    whole = [int(_MANTISSA * i / w) for i, w in zip(inner, width)]
    return [value / _MANTISSA for value in width], whole, density


_WIDTHS, _WHOLE, _HEIGHTS = _ziggurat()
