"""The population as a simulator's randomisation: parts of the batch drawn for every episode.

What is drawn is a covariance a block of parameters, between blocks nothing: of tens of boards no
more can be known. The few boards that are not of the batch are left out.
"""
import json

import numpy as np

from . import parameters

NAMES = {"numpy": "imu_numpy.py", "mujoco": "imu_mujoco.py", "isaaclab": "imu_isaaclab.py"}
EFFECTS = ("accel.thermal_bias", "gyro.thermal_bias", "gyro.g_sensitivity")
# What a form has no place for: Isaac Lab's noise models see no temperature.
NO_PLACE = {"isaaclab": ("accel.thermal_bias", "gyro.thermal_bias")}

CORE = '''"""%(title)s
%(about)s
"""
import json

import numpy as np

CANNOT_EXPRESS = %(cannot)s
G = 9.80665
REFERENCE_C = 25.0
# Of each block the names of its parameters, their mean and covariance over the batch.
BATCH = json.loads("""
%(batch)s
""")


def draw(random, n):
    """{parameter: (n,)} of n parts; random: numpy.random.Generator."""
    parts = {}
    for block in BATCH.values():
        values = random.multivariate_normal(block["mean"], block["covariance"], n, method="eigh")
        parts.update(zip(block["names"], values.T))
    return parts


def triads(parts, sensor):
    """(matrix (n, 3, 3), bias (n, 3), noise (n, 3) per root Hz): true to read, m/s2 or rad/s."""
    unit, end = (G / 1000.0, "mg") if sensor == "accel" else (np.pi / 180.0, "dps")
    n = len(next(iter(parts.values())))

    def of(name, default=0.0):
        return np.broadcast_to(parts.get(sensor + name, default), (n,))
    scale = np.stack([of("_scale_" + a, 1.0) for a in "xyz"], -1)
    turned = np.zeros((n, 3, 3)) + np.eye(3)
    for i, a in enumerate("xyz"):
        for j, b in enumerate("xyz"):
            if i != j:
                turned[:, i, j] = np.radians(of("_misalignment_%%s%%s_deg" %% (a, b)))
    matrix = np.linalg.inv(turned * scale[:, None, :])
    bias = unit * np.stack([of("_bias_%%s_%%s" %% (a, end)) for a in "xyz"], -1)
    noise = unit * np.stack([of("_noise_%%s_%%s" %% (a, end)) for a in "xyz"], -1)
    return matrix, bias, np.maximum(noise, 0.0)


class Imu:
    """n sensors of the batch. read() takes specific force (n, 3) m/s2 and turn rate (n, 3) rad/s
    in the sensor's axes and returns what each part reads."""

    def __init__(self, n=1, seed=0):
        self.random, self.n = np.random.default_rng(seed), n
        self.redraw()

    def redraw(self):
        """Other parts of the same batch, for the next episode."""
        self.parts = draw(self.random, self.n)
        self.settle()

    def settle(self):
        """Matrices and biases of the parts as they are."""
        self.accel, self.gyro = triads(self.parts, "accel"), triads(self.parts, "gyro")
        self.accel_slope = self._effect("accel.thermal_bias", G / 1000.0)
        self.gyro_slope = self._effect("gyro.thermal_bias", np.pi / 180.0)
        self.pull = np.stack([np.stack([
            self._one("gyro.g_sensitivity." + a + b) for b in "xyz"], -1) for a in "xyz"], 1)

    def _one(self, name):
        return np.radians(np.broadcast_to(self.parts.get(name, 0.0), (self.n,)))

    def _effect(self, name, unit):
        return unit * np.stack([np.broadcast_to(self.parts.get(name + "." + a, 0.0), (self.n,))
                                for a in "xyz"], -1)

    def read(self, force, rate, dt, temperature=REFERENCE_C):
        """(force (n, 3), rate (n, 3)) as read; dt: s since the last sample."""
        force, rate = np.atleast_2d(force), np.atleast_2d(rate)
        warm = temperature - REFERENCE_C
        matrix, bias, noise = self.accel
        read = np.einsum("nij,nj->ni", matrix, force) + bias + self.accel_slope * warm \\
            + noise / np.sqrt(dt) * self.random.normal(size=(self.n, 3))
        matrix, bias, noise = self.gyro
        turn = np.einsum("nij,nj->ni", matrix, rate) + bias + self.gyro_slope * warm \\
            + np.einsum("nij,nj->ni", self.pull, force / G) \\
            + noise / np.sqrt(dt) * self.random.normal(size=(self.n, 3))
        return read, turn
'''

MUJOCO = '''

def apply(imu, model, data, dt, accelerometer="imu_accelerometer", gyro="imu_gyro",
          temperature=REFERENCE_C):
    """Put what a part reads into data.sensordata, after mj_step: sensors by their names in the
    model; imu: an Imu(1), redrawn at each reset; temperature: of the sensor, degC."""
    places = []
    for name in (accelerometer, gyro):
        first = int(model.sensor(name).adr[0])
        places.append(slice(first, first + 3))
    read = imu.read(data.sensordata[places[0]], data.sensordata[places[1]], dt,
                    temperature)
    for place, values in zip(places, read):
        data.sensordata[place] = values[0]
'''

ISAACLAB = '''

class RandomImu:
    """The noise of the observation terms of an Isaac Lab environment: one part of the batch for
    each environment, another after reset(env_ids). accel and gyro take the tensors
    (environments, 3) of imu_lin_acc, gravity in it, and imu_ang_vel."""

    def __init__(self, num_envs, device, dt, seed=0):
        import torch
        self.torch, self.device, self.dt = torch, device, dt
        self.imu = Imu(num_envs, seed)
        self._tensors()

    def _tensors(self):
        def there(value):
            return self.torch.as_tensor(np.asarray(value, np.float32), device=self.device)
        self._accel = [there(part) for part in self.imu.accel]
        self._gyro = [there(part) for part in self.imu.gyro]
        self._pull = there(self.imu.pull)

    def reset(self, env_ids):
        """Other parts for these environments: what an EventTerm of mode "reset" calls."""
        kept = {name: value.copy() for name, value in self.imu.parts.items()}
        self.imu.redraw()
        others = np.ones(self.imu.n, bool)
        others[np.asarray([int(k) for k in env_ids])] = False
        for name, value in kept.items():
            self.imu.parts[name][others] = value[others]
        self.imu.settle()
        self._tensors()

    def _read(self, triad, true):
        matrix, bias, noise = triad
        return self.torch.einsum("nij,nj->ni", matrix, true) + bias \\
            + noise / self.dt ** 0.5 * self.torch.randn_like(true)

    def accel(self, force):
        """What the accelerometers read, m/s2."""
        return self._read(self._accel, force)

    def gyro(self, rate, force):
        """What the gyros read, rad/s."""
        return self._read(self._gyro, rate) + self.torch.einsum(
            "nij,nj->ni", self._pull, force / G)
'''


def files(members, batches):
    """{name: text} of every form, for the boards of one kind."""
    batch = pooled(batches)
    about = "%s, %d boards. Drawn are %s." % (
        members.spelled(), len(members.boards), ", ".join(sorted(batch)))
    missing = cannot_express(batches)
    ends = {"numpy": "", "mujoco": MUJOCO, "isaaclab": ISAACLAB}
    texts = {}
    for form, name in NAMES.items():
        without = "\nThis form cannot express: %s." % ", ".join(missing[name])
        texts[name] = CORE % {
            "title": "Parts of a batch, drawn: written by sixflip fleet --randomise.",
            "about": "\n" + about + (without if missing[name] else ""),
            "cannot": json.dumps(missing[name]), "batch": json.dumps(batch, indent=1)} + ends[form]
    return texts


def cannot_express(batches):
    """{name of the file: [effect in words]}: what the boards have, all of them or each its own,
    and a form does not apply."""
    has = dict.fromkeys(p.name.rpartition(".")[0] for b in batches for p in b.parameters
                        if "." in p.name and p.kind != "neither")
    return {name: ["%s of the %s" % (effect, sensor)
                   for sensor, effect in (one.split(".") for one in has
                                          if one not in EFFECTS or one in NO_PLACE.get(form, ()))]
            for form, name in NAMES.items()}


def pooled(batches):
    """{block: {names, mean, covariance}} over all batches of a kind: within them and between."""
    blocks = {}
    for name in (*parameters.BLOCKS, *EFFECTS):
        own = [(len(b.boards), *b.populations[name]) for b in batches if name in b.populations]
        if not own:
            continue
        n = np.array([one[0] for one in own], float)
        means = np.array([one[2].mean for one in own])
        mean = n @ means / n.sum()
        away = means - mean
        covariance = np.einsum("b,bij->ij", n, [one[2].spread for one in own]) / n.sum() \
            + np.einsum("b,bi,bj->ij", n, away, away) / n.sum()
        known = np.diag([one[2].error for one in own][0]) < 1e6 * np.maximum(
            np.diag(covariance), 1e-12)
        if not known.all() or not np.isfinite(covariance).all():
            continue  # an axis that no board tells
        blocks[name] = {"names": list(own[0][1].names), "mean": mean.tolist(),
                        "covariance": covariance.tolist()}
    return blocks
