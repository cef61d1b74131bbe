"""The calibration as Li Eq. 5 writes it: a_t = T S (a_m + v)."""

from sixflip.accelerometer.normal_equations import SingularSystem


def inverse3(a):
    """Inverse of a 3 x 3 matrix by cofactors. Raises SingularSystem."""
    b = [[a[(j + 1) % 3][(i + 1) % 3] * a[(j + 2) % 3][(i + 2) % 3]
          - a[(j + 1) % 3][(i + 2) % 3] * a[(j + 2) % 3][(i + 1) % 3]
          for j in range(3)] for i in range(3)]
    d = a[0][0] * b[0][0] + a[0][1] * b[1][0] + a[0][2] * b[2][0]
    if not abs(d) > 1e-6:
        raise SingularSystem("the 3 x 3 matrix has no inverse")
    return [[x / d for x in row] for row in b]


def scale_form(P):
    """P (row vectors, 4 x at least 3) -> T 3 x 3, S [3], v [3] in P's units, A^-1.

    A = P[0:3]' and o = P[3]: S = diag(A), T_ij = A_ij / A_jj (unit diagonal, six small
    angles), v = A^-1 o, to be added to the measured values. Li's Eq. 6 reuses the letter v
    for the product T S v.
    """
    A = [[P[j][i] for j in range(3)] for i in range(3)]
    inverse = inverse3(A)
    scale = [A[i][i] for i in range(3)]
    T = [[A[i][j] / scale[j] if scale[j] else float("nan") for j in range(3)]
         for i in range(3)]
    v = [sum([inverse[i][j] * P[3][j] for j in range(3)]) for i in range(3)]
    return T, scale, v, inverse
