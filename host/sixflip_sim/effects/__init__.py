"""Every canonical effect, defined once, for simulator and diagnosis.

`make(specs, seed)` gives what sensor_model.SensorModel takes as `effects`; library.make(spec)
gives a single Effect with its terms.
"""


def make(specs, seed=1, session=0):
    """[Chain] from a list of {"effect": name, …}; BadEffect (a ValueError) says what was
    expected."""
    from sixflip_sim.effects.chain import Chain
    from sixflip_sim.effects.library import make as make_one
    return [Chain([make_one(spec) for spec in specs], seed, session)]
