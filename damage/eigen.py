"""Eigenvalues and vectors of small symmetric matrices, with the same bits on every machine.

Jacobi's cyclic rotations consist of sums, products, quotients and square roots, which IEEE 754
rounds in one way; what LAPACK does depends on the machine.  They keep small eigenvalues of positive
definite matrices as accurate as they are determined (J. Demmel, K. Veselic (1992), Jacobi's method
is more accurate than QR, SIAM J. Matrix Anal. 13(4)).
"""

import math

import numpy as np

_NEGLIGIBLE = 2.0**-108
"""Square of an element off the diagonal, beside the product of those on it in its row and
column."""
_MOST_SWEEPS = 60


def eigen(matrix):
    """Eigenvalues (n,), as they come, and orthonormal vectors, the columns of (n, n), of a
    symmetric matrix without negative eigenvalues."""
    matrix, vectors = np.array(matrix, float), np.eye(len(matrix))
    pairs = [(p, q) for p in range(len(matrix)) for q in range(p + 1, len(matrix))]
    for _ in range(_MOST_SWEEPS):
        turned = False
        for p, q in pairs:
            first = float(matrix[p, p])
            second = float(matrix[q, q])
            beside = float(matrix[p, q])
            if beside * beside <= abs(first * second) * _NEGLIGIBLE:
                continue
            turned = True
            half = (second - first) / (2 * beside)
            tangent = math.copysign(1.0, half) / (abs(half) + math.sqrt(half * half + 1))
            cos = 1 / math.sqrt(tangent * tangent + 1)
            rotate(matrix, p, q, cos, -tangent * cos)
            rotate(matrix.T, p, q, cos, -tangent * cos)
            matrix[p, q] = matrix[q, p] = 0.0
            rotate(vectors, p, q, cos, -tangent * cos)
        if not turned:
            break
    return np.diagonal(matrix).copy(), vectors.T


def rotate(matrix, p, q, cos, sin):
    """Replace rows p and q of a matrix by cos times the one plus sin times the other, and that less
    sin times the one."""
    matrix[p], matrix[q] = cos * matrix[p] + sin * matrix[q], cos * matrix[q] - sin * matrix[p]
