"""A person who reacts: turns the box when a pose is taken, puts it down again when it is not."""

from sixflip_sim.operator import PAPER_ORDER

REACTION_S = 0.2
PATIENCE_S = 9.0   # without a pose, before the box is lifted and put down again


class ReactingHand:
    """see(event) with every event of the firmware; moves the operator of a world whose order is
    []: the box lies on Z+ until the first pose is taken."""

    def __init__(self, world):
        self._world = world
        self._since = world.clock.now_us()

    def see(self, event):
        kind = event["event"]
        if kind in ("calibrating", "pose"):
            self._go_on(event["missing"], kind == "calibrating")
        elif kind == "refused" and event["reason"] != "moving" or self._impatient(kind):
            self._put_down_again()

    def _impatient(self, kind):
        waited = self._world.clock.now_us() - self._since
        return kind == "state" and waited > PATIENCE_S * 1e6

    def _wait(self):
        """The scene up to now, and as long as a person takes to react."""
        now = self._world.clock.now_us()
        self._world.operator.rest_until(now + int(REACTION_S * 1e6))
        self._since = now

    def _go_on(self, missing, begins):
        operator = self._world.operator
        self._wait()
        if begins or not missing:
            return
        faces = [pose[:2] for pose in missing]
        if operator.pose[:2] in faces:  # whatever it calls the pose: half a turn
            operator.flip()
        else:
            operator.place(min(missing, key=PAPER_ORDER.index))

    def _put_down_again(self):
        self._wait()
        self._world.operator.touch(3.0, 0.6)
