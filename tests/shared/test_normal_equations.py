import unittest

from sixflip.accelerometer.normal_equations import (
    DOUBLE,
    NormalEquations,
    SingularSystem,
    eliminate,
)
from sixflip.accelerometer.scale_form import inverse3, scale_form

TIGHT = 1e-12 if DOUBLE else 2e-5


class Solve(unittest.TestCase):
    def near(self, a, b, delta=TIGHT):
        for row, expected in zip(a, b):
            for x, y in zip(row, expected):
                self.assertAlmostEqual(x, y, delta=delta)

    def test_exact_rows_give_their_parameters_back(self):
        P = [[1.02, 0.03], [-0.04, 0.97], [0.01, 0.02], [0.5, -0.25]]
        equations = NormalEquations(2)
        for row in ([1, 0, 0, 1], [-1, 0, 0, 1], [0, 1, 0, 1], [0, -1, 0, 1], [0, 0, 1, 1],
                    [0.3, 0.2, -1, 1]):
            equations.add(row, [sum([row[k] * P[k][j] for k in range(4)]) for j in range(2)])
        self.near(equations.solve(), P)
        self.assertEqual(equations.rows, 6)

    def test_weight_two_is_the_row_twice(self):
        rows = ([1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1], [-1, -1, 0, 1], [0.5, 0, -1, 1])
        once, twice = NormalEquations(1), NormalEquations(1)
        for i, row in enumerate(rows):
            once.add(row, [float(i * i)], 2.0 if i == 1 else 1.0)
            twice.add(row, [float(i * i)])
        twice.add(rows[1], [1.0])
        self.near(once.solve(), twice.solve())

    def test_the_inverse_times_the_matrix_is_one(self):
        equations = NormalEquations(1)
        for row in ([1, 0.2, 0, 1], [0, -1, 0.1, 1], [0, 0, 3, 1], [-1, 0.3, 0, 1], [0, 1, 1, 1]):
            equations.add(row, [0.0])
        c = equations.inverse()
        unit = [[sum([equations.xx[i][k] * c[k][j] for k in range(4)]) for j in range(4)]
                for i in range(4)]
        self.near(unit, [[float(i == j) for j in range(4)] for i in range(4)])

    def test_columns_of_very_different_size(self):
        equations = NormalEquations(1)
        for row in ([1e4, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1e-3, 1], [-1e4, 0, 0, 1], [0, -2, 0, 1]):
            equations.add(row, [row[0] * 2e-4 + row[1] * 3 + row[2] * 4e3 + 5])
        found = equations.solve()
        for x, y in zip(found, (2e-4, 3, 4e3, 5)):
            self.assertAlmostEqual(x[0] / y, 1.0, delta=TIGHT * 100)

    def test_a_zero_on_the_diagonal_is_pivoted_away(self):
        self.near(eliminate([[1, 1, 0], [1, 1, 1], [0, 1, 2]], [[3], [6], [8]]),
                  [[1], [2], [3]])

    def test_what_is_missing_is_said(self):
        for rows, word in ((([1, 0, 0, 1], [0, 1, 0, 1], [-1, 0, 0, 1]), "column 3"),
                           (([1, 0, 1, 1], [0, 1, 0, 1], [-1, 0, -1, 1], [0, 0, 0, 1]), "pivot"),
                           (([float("nan"), 0, 0, 1],), "not finite")):
            equations = NormalEquations(1)
            for row in rows:
                equations.add(row, [1.0])
            with self.assertRaises(SingularSystem) as caught:
                equations.solve()
            self.assertIn(word, str(caught.exception))
        self.assertTrue(issubclass(SingularSystem, ValueError))


class ScaleForm(unittest.TestCase):
    def test_unit_diagonal_and_six_small_angles(self):
        # By hand: A = T diag(S) with T_xy = 0.02, and o = A v.
        S, v = (0.98, 1.01, 1.05), (0.1, -0.2, 0.3)
        T = ((1, 0.02, 0), (-0.01, 1, 0.03), (0, 0.015, 1))
        A = [[T[i][j] * S[j] for j in range(3)] for i in range(3)]
        P = [[A[j][i] for j in range(3)] for i in range(3)]
        P.append([sum([A[i][k] * v[k] for k in range(3)]) for i in range(3)])
        t, s, u, _ = scale_form(P)
        for i in range(3):
            self.assertAlmostEqual(s[i], S[i], delta=TIGHT)
            self.assertAlmostEqual(u[i], v[i], delta=TIGHT)
            for j in range(3):
                self.assertAlmostEqual(t[i][j], T[i][j], delta=TIGHT)

    def test_a_flat_matrix_has_no_inverse(self):
        self.assertRaises(SingularSystem, inverse3, [[1, 2, 3], [2, 4, 6], [0, 0, 1]])


if __name__ == "__main__":
    unittest.main()
