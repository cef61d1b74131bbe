"""Roll and pitch of an installed sensor from gravity at rest (Promrit)."""

import math

import numpy as np

from sixflip.chips.catalogue import SENSORS
from sixflip.record import mounting
from sixflip.record.correction import correction_of
from sixflip.record.still_valid import NOISE_TIMES
from sixflip_sim.worlds import usual_noise

from ..calibrate import verify_files
from ..capture import rests
from ..errors import CheckFailed

CALIBRATED_OFF = 0.02   # g: |a| of a calibrated sensor at rest
RAW_OFF = 0.15          # g: what an uncalibrated one may show (ADXL345: 40 mg an axis, 4 %)
TURNING_DPS = 5.0       # a bias changes by less from one switching-on to the next
LARGEST_BIAS_DPS = 40.0     # ITG3205 data sheet, zero-rate output


def gravity_of(capture, record):
    """(G in g, sensor axes; facts about the rest) or CheckFailed with the reason."""
    rest = rests.longest(capture)
    if rest.reason:
        raise CheckFailed("no mounting measured, the vehicle is not at rest: %s" % rest.reason)
    if record is not None:
        verify_files.fits(record, capture)
    noise, worst = rest.noise_mg(capture.meta["accel_lsb_per_g"])
    usual = usual_noise_mg(record, capture.meta["sensor"])
    # An engine shakes along one axis more than along the others.
    if usual and worst > NOISE_TIMES * usual:
        raise CheckFailed("no mounting measured, the sensor shakes: %.1f mg of noise, at rest it "
                          "has %.1f, limit %.1f; stop the engine" % (
                              worst, usual, NOISE_TIMES * usual))
    _not_turning(rest, capture, record)
    if record is None:
        G = [x / capture.meta["accel_lsb_per_g"] for x in rest.means[:3]]
    else:
        # The mounting it may hold already must not turn what is to be measured.
        held, record.mounting = record.mounting, None
        G = [x / record.g for x in correction_of(record).apply(rest.means, [0.0] * 6)[:3]]
        record.mounting = held
    sigma = math.degrees(noise / 1e3 / math.sqrt(rest.n))
    return G, {"samples": rest.n, "noise_mg": noise, "usual_noise_mg": usual,
               "angle_sigma_deg": sigma}


def usual_noise_mg(record, sensor):
    """Noise of one sample at rest: what the calibration found, else what such a sensor has."""
    if record is not None and record.accel and record.accel["noise_g"]:
        return 1e3 * record.accel["noise_g"]
    return usual_noise(sensor)[0] if sensor in SENSORS else None


def _not_turning(rest, capture, record):
    """A slow steady turn looks like a bias; a known bias tells them apart, or sheer size."""
    if capture.gyro is None:
        return
    known = record is not None and record.gyro_bias is not None
    then = record.gyro_bias["bias_dps"] if known else [0.0] * 3
    limit = TURNING_DPS if known else LARGEST_BIAS_DPS
    for k in range(3):
        now = rest.means[3 + k] / capture.meta["gyro_lsb_per_dps"]
        if abs(now - then[k]) > limit:
            raise CheckFailed(
                "no mounting measured, the vehicle turns or the gyro's bias has jumped: axis %s "
                "reads %.1f deg/s, expected %.1f, give or take %.0f" % (
                    "xyz"[k], now, then[k], limit))


def answer(G, axes, order=None, record=None, calibrated=True):
    """The answer as a dictionary: G in g in sensor axes, axes of robot_axes.parse.

    CheckFailed when |G| is not gravity's.
    """
    size = math.sqrt(sum(x * x for x in G))
    limit = CALIBRATED_OFF if calibrated else RAW_OFF
    if not abs(size - 1.0) <= limit:
        raise CheckFailed("gravity reads %.3f g, %.2f to %.2f is the limit: the vehicle moves, or "
                          "%s" % (size, 1 - limit, 1 + limit, "the record is not this sensor's"
                                  if record is not None else "the sensor is not calibrated"))
    if not calibrated:
        G = [x / size for x in G]       # an angle needs the direction alone
    B = np.array(mounting.parse_axes(axes.axes))
    chosen, left, right = mounting.choose(*(B @ G))
    both = {one: _one(G, axes, one) for one in ("xyz", "yxz")}
    order = order or chosen
    here = both[order]
    mirror = np.diag(axes.mirror)
    C = mirror @ mounting.compensation(here)
    return {"format": 1, "kind": "sixflip mounting", "G": list(G), "G_size": size,
            "calibrated": calibrated, "order": order, "rule": {
                "order": chosen, "left": left, "right": right},
            "roll_deg": here["roll_deg"], "pitch_deg": here["pitch_deg"], "yaw_deg": 0.0,
            "axes": axes.asked, "frame": axes.frame, "left_handed": axes.left_handed,
            "mounting": here, "both": both, "compensation": C.tolist(),
            # a rate is a pseudovector: mirrored axes turn its sign round
            "gyro_compensation": (C * (-1 if axes.left_handed else 1)).tolist(),
            "G_robot": (np.round(C @ G, 12) + 0.0).tolist(),      # no -0.0000 to look at
            "chain_differs_mg": _record_chain_mg(record, B, here)}


def _one(G, axes, order):
    """The mounting section in one order."""
    return mounting.estimate(*G, order=order, axes=axes.axes, frame=axes.frame)


def _record_chain_mg(record, B, here):
    if record is None:
        return None
    R = np.array(mounting.rotation(math.radians(here["roll_deg"]),
                                   math.radians(here["pitch_deg"]), here["order"]))
    A = np.array(record.accel["P"])[:3, :3].T       # true = A measured + o
    return chain_difference_mg(np.linalg.inv(A) - np.eye(3), B.T @ R)


def chain_difference_mg(E, R):
    """Length of R (I+S+M) a - (I+S+M) R a for a = gravity on a level vehicle, mg.

    The paper chains measured = R (I+S+M) a + b (IV, last equation): the sensor's errors before
    the rotation. They are the chip's and act on what arrives in its axes, after it:
    measured = (I+S+M) R a + b. E = S + M. With scale errors of +2, +0.5 and -1 % at roll 30 and
    pitch 15 degrees the two differ by 10.6 mg.
    """
    E, R = np.asarray(E), np.asarray(R)
    return 1e3 * float(np.linalg.norm((R @ E - E @ R) @ [0.0, 0.0, 1.0]))
