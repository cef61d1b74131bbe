"""What a session can tell: singular values of the scaled Jacobian, in words.

Each column of the Jacobian is divided by the residual's noise and multiplied by what a sensor
of the trade typically has in that parameter. A singular value of s then says that the session
narrows that direction s-fold; below ENOUGH it hardly says anything, and a number quoted for it
would be noise amplified (six faces and |a| = g alone: 16 mg, with a perfect cost).
"""

import numpy as np

ENOUGH = 10.0  # times narrower than the data sheets' spread
NAMED = 0.3  # share of a parameter in the open directions above which it is named

LISTED = 9  # names in a sentence; more are counted


def undetermined(jacobian, names, typical, enough=ENOUGH):
    """Directions the residuals leave open: list of (singular value, {name: share}).

    jacobian (n, p) of whitened residuals; names and typical sizes of the p parameters.
    """
    scaled = np.asarray(jacobian) * np.asarray(typical)[None, :]
    if len(scaled) < scaled.shape[1]:
        scaled = np.vstack([scaled, np.zeros((scaled.shape[1] - len(scaled), scaled.shape[1]))])
    _, values, right = np.linalg.svd(scaled, full_matrices=False)
    weak = values < enough
    if not weak.any():
        return []
    # The basis within the weak space is arbitrary; its projector is not.
    share = np.sum(right[weak] ** 2, axis=0)
    order = np.argsort(-share)
    shares = {names[k]: float(share[k]) for k in order if share[k] > NAMED}
    return [(float(value), shares) for value in values[weak]]


def sentence(lost, parameters):
    """One line for a person: which parameters these poses cannot tell."""
    if not lost:
        return ""
    names = sorted(lost[0][1], key=lambda name: not name.startswith("accelerometer"))
    more = " and %d more" % (len(names) - LISTED) if len(names) > LISTED else ""
    return (
        "these poses determine %d of %d parameters; not determined: %s%s "
        "(add poses leaning about 45 degrees between the faces, or label the faces and flip)"
        % (parameters - len(lost), parameters, ", ".join(names[:LISTED]), more)
    )
