"""What the gyro reads while it rests: bias, and how far gravity pulls at it."""

import numpy as np

FEWEST_RESTS = 8
WORTH_IT = 2.0  # chi2/dof must fall this many times over before nine more terms are believed


def regress(session):
    """Rest means of each gyro axis as bias + per_g . force, and without per_g.

    session: RestsAndMoves. Returns (chi2/dof without (3,), with (3,), per_g (3, 3) rad/s a g).
    """
    x = np.hstack([np.ones((len(session.force), 1)), session.force])
    weight = 1.0 / session.rate_error[:, None]
    chi2 = []
    for columns in (x[:, :1], x):
        found = np.linalg.lstsq(columns * weight, session.rate * weight, rcond=None)[0]
        left = (session.rate - columns @ found) * weight
        chi2.append((left**2).sum(axis=0) / (len(x) - columns.shape[1]))
    return chi2[0], chi2[1], found[1:].T


def pulled_by_gravity(session):
    """True when the rests say that g-sensitivity is there and can be told from the bias."""
    if not session.has_gyro or len(session.codes) < FEWEST_RESTS:
        return False
    spread = np.linalg.svd(session.force - session.force.mean(axis=0), compute_uv=False)
    if spread[-1] < 0.5:
        return False
    without, with_it, _ = regress(session)
    return bool(without.mean() > WORTH_IT * max(with_it.mean(), 1.0))
