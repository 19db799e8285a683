"""Random numbers with the same bits on every machine and under every version of numpy.

numpy guarantees the bits of a seeded PCG64 (NEP 19), not what its Generator makes of them.  The transforms here are
those of numpy 1.17 to 2.4, so that seeds keep their draws: uniform numbers of 53 bits, whole numbers by the method of
D. Lemire (2019), ACM Trans. Model. Comput. Simul. 29(1), 3, normal numbers by the ziggurat of G. Marsaglia and
W. W. Tsang (2000), J. Stat. Softw. 5(8).
"""

import math

import numpy as np

from damage.elementary import exp, log

_LAYERS, _EDGE, _AREA = 256, 3.6541528853610087963519472518, 0.00492867323397465524494
"""Of the ziggurat: layers, where its tail begins, area of a layer."""
_MANTISSA = 2.0**52


class Draws:
    """A stream of random numbers by a seed, an integer or a sequence of integers as of numpy.random.SeedSequence."""

    def __init__(self, seed):
        self._bits, self._half = np.random.PCG64(seed), None

    def uniform(self, n):
        """Numbers (n,) from 0 to 1, below 1."""
        return (self._bits.random_raw(n) >> np.uint64(11)).astype(float) * 2.0**-53

    def below(self, number):
        """A whole number from 0 to number - 1, of a number up to 2**32."""
        if number == 1:
            return 0
        product = self._of_32_bits() * number
        while product % 2**32 < (2**32 - number) % number:
            product = self._of_32_bits() * number
        return product >> 32

    def normal(self, n):
        """Numbers (n,) of mean 0 and standard deviation 1."""
        return np.array([self._one_normal() for _ in range(n)])

    def _of_32_bits(self):
        if self._half is None:
            word = int(self._bits.random_raw())
            self._half = word >> 32
            return word & 0xFFFFFFFF
        half, self._half = self._half, None
        return half

    def _one_normal(self):
        while True:
            word = int(self._bits.random_raw())
            layer, negative, size = word & 0xFF, word >> 8 & 1, word >> 9 & 0xFFFFFFFFFFFFF
            x = size * _WIDTHS[layer]
            if size < _WHOLE[layer]:
                return -x if negative else x
            if layer == 0:
                return self._tail(size >> 8 & 1)
            above, below = _HEIGHTS[layer - 1], _HEIGHTS[layer]
            if (above - below) * float(self.uniform(1)[0]) + below < float(exp(-0.5 * x * x)):
                return -x if negative else x

    def _tail(self, negative):
        while True:
            across, up = (-float(log(1.0 - one)) for one in self.uniform(2))
            across /= _EDGE
            if 2.0 * up > across * across:
                return -(_EDGE + across) if negative else _EDGE + across


def _ziggurat():
    """Of every layer, lists: its width over 2**52, the size below which a point is inside the next layer, too, and the
    density exp(-x^2 / 2) at its width.  Layer 0 is the base with the tail, the others grow from the top down."""
    width, density = [_EDGE], [float(exp(-0.5 * _EDGE * _EDGE))]
    while len(width) < _LAYERS - 1:
        density.append(density[-1] + _AREA / width[-1])
        width.append(math.sqrt(-2.0 * float(log(density[-1]))))
    width, density = [_AREA / density[0], *reversed(width)], [1.0, *reversed(density)]
    inner = [_EDGE, 0.0, *width[1:-1]]
    return ([w / _MANTISSA for w in width], [int(_MANTISSA * i / w) for i, w in zip(inner, width)], density)


_WIDTHS, _WHOLE, _HEIGHTS = _ziggurat()
