"""The guided session: which rests of the box are poses, which pose each is, what is missing.

Fed sample by sample; between window ends nothing but small integers, nothing allocated.
Time is the samples' own (dt_us), never a clock's.
"""

from sixflip.poses.faces import AXIS, face_of_code, nearest_face
from sixflip.poses.noise_floor import ENTER, LEAVE, NoiseFloor
from sixflip.poses.placement_log import PlacementLog, absorb, add_window, empty_move
from sixflip.poses.pose_label import PoseLabel, turned_deg
from sixflip.poses.pose_sums import PoseSums
from sixflip.poses.still_window import StillWindow, window_length

NOTHING = 0
WINDOW = 1  # a window ended: state, reason, value, limit, unit, progress are fresh
POSE = 2  # accepted: placements[-1]; what it replaces is in `withdrawn`
REFUSED = 3  # a rest or a capture was refused: reason
COMPLETE = 4  # accepted, and nothing is missing any more
TIMED_OUT = 5  # nothing accepted for timeout_s; what stood in the way is in `obstacle`

SETTLE_WINDOWS = 2  # still windows (0.5 s) before the capture starts
US = 1000000
# Without a gyro a flip shows only by its motion, and a knock on the table must not pass for one.
KNOCK_US = 500000  # longest knock that still counts as one, microseconds
KNOCKS_S = 3  # least time between two knocks, seconds


class Session:
    """state is "measuring noise", "moving" (waiting for the box to come to rest in a new
    place), "settling", "capturing" or "done"; face, candidate, progress say what is underway.

    accel_lsb_per_g, gyro_lsb_per_dps  counts; the latter 0 without a gyro
    accel_rail, gyro_rail              |count| at or beyond is saturated
    wanted   codes in the order planned (repeats and leaning poses too), or None: the twelve
             in any order
    timeout_s  seconds without an accepted pose
    """

    def __init__(self, accel_lsb_per_g, gyro_lsb_per_dps, accel_rail, gyro_rail, rate_hz,
                 pose_samples=400, wanted=None, timeout_s=180):
        length = window_length(rate_hz, pose_samples)
        self.windows = -(-pose_samples // length)
        self.pose_samples = self.windows * length
        self.gyro_lsb_per_dps = gyro_lsb_per_dps
        self.wanted = list(wanted) if wanted else None
        self.timeout_s = timeout_s
        self.samples = 0
        self.withdrawn = []
        self.obstacle = ""
        period_us = int(US / rate_hz + 0.5)
        self._handled = 2 - -KNOCK_US // (length * period_us)  # windows, more than a knock touches
        self._window = StillWindow(
            length, accel_rail, gyro_rail if gyro_lsb_per_dps else 0, period_us
        )
        self._noise = NoiseFloor(accel_lsb_per_g, gyro_lsb_per_dps)
        self._log = PlacementLog(period_us, gyro_lsb_per_dps)
        self.placements = self._log.placements  # in force
        self.moves = self._log.moves
        self._pose = None
        self._settled = 0
        self._turn = empty_move(0)  # windows not still since the last placement, for the flip
        self._moved = 0  # such windows since the last rest was dealt with,
        self._moved_at = 0  # the last of them at this second
        self._rested = False  # that rest still lasts,
        self._rest_face = -1  # on this face
        self._away = False  # another face was rested on since the last placement
        self._seconds = 0
        self._us = 0
        self._since = 0  # second at which the last pose was accepted
        self.left_s = timeout_s  # seconds until the time-out
        self.state = "measuring noise"
        self._show("", 0, 0, "")
        self._idle()

    def _show(self, reason, value, limit, unit):
        self.reason = reason
        self.value = value
        self.limit = limit
        self.unit = unit

    def _show_of(self, source):
        self._show(source.reason, source.value, source.limit, source.unit)

    def _idle(self):
        self._pose = None
        self._settled = 0
        self.face = -1
        self.candidate = 0
        self.progress = 0

    def live(self):
        """Means of the last window: mg of three axes, and with a gyro deg/s of three."""
        noise = self._noise
        return [round(noise.mean[i] / noise.lsb[i // 3]) for i in range(noise.axes)]

    def missing(self):
        """Codes still to come, in the order planned."""
        have = [p.pose for p in self.placements]
        missing = []
        for code in self.wanted or range(1, 13):
            if code in have:
                have.remove(code)
            else:
                missing.append(code)
        return missing

    def redo(self, face):
        """Drop the placements of a face (0..5), answer their codes (in `withdrawn` too).

        A box that rests on it is captured at once; a capture on another face goes on.
        """
        self.withdrawn.clear()
        last = self.placements[-1] if self.placements else None
        for code in (1 + 2 * face, 2 + 2 * face):
            if self._log.drop(code):
                self.withdrawn.append(code)
        if last and face_of_code(last.pose) == face:
            self._away = True  # what comes next does not follow on the placement before
        if self._rest_face == face:
            self._rested = False
        self._since = self._seconds
        self.left_s = self.timeout_s
        if self._pose is None or self.wanted or self.face == face:
            self._give_up_pose()
            self.state = "moving" if self._noise.known else "measuring noise"
        return list(self.withdrawn)

    def interrupt(self):
        """Samples were lost, or the chip was set up anew: the capture under way and this window
        do not count. What was accepted stays, and is not taken again while the box rests on.
        """
        self._give_up_pose()
        self._window.jumped = not self._rested
        if self.state != "done":
            self.state = "moving" if self._noise.known else "measuring noise"

    def feed(self, dt_us, sample):
        """One sample (ax ay az gx gy gz temp, counts), dt_us microseconds after the last."""
        self.samples += 1
        if not self._window.add(dt_us, sample):
            return NOTHING
        return self._window_end()

    def _window_end(self):
        window = self._window
        self._us += window.us
        self._seconds += self._us // US
        self._us %= US
        self.left_s = max(0, self.timeout_s - (self._seconds - self._since))
        if self._pose is None:
            self._log.add(window)
        known = self._noise.known
        self._noise.look(window)
        if self.state == "done":
            return NOTHING
        self.withdrawn.clear()
        if not known:
            event = WINDOW
            self._show_of(self._noise)
            if self._noise.known:
                self.state = "moving"
        elif self._pose:
            event = self._capture()
        else:
            event = self._wait()
        if event < POSE and self._pose is None and self.left_s <= 0:
            self.obstacle = self.reason or self.state
            self._idle()
            self.state = "done"
            self._show("timed out", self._seconds - self._since, self.timeout_s, "s")
            event = TIMED_OUT
        return event

    def _wait(self):
        """No capture under way: has the box moved, has it come to rest again?"""
        window = self._window
        still = self._settled or self._rested and self.gyro_lsb_per_dps
        limit = LEAVE if still else ENTER  # without a gyro a turn shows by the hand's tremor alone
        if self._noise.judge(window, limit):
            self._moving(window)
            if self._moved >= self._handled or self.gyro_lsb_per_dps:
                self._rested = False
            self._idle()
            self.state = "moving"
            self._show_of(self._noise)
            return WINDOW
        if self._rested:  # the reason of a refusal stays until the box moves
            return WINDOW
        self._show_of(self._noise)
        self._settled += 1
        self.state = "settling"
        if self._settled < SETTLE_WINDOWS:
            return WINDOW
        return self._begin()

    def _moving(self, window):
        """Long rests stay out of the turn: there an error of the bias would add up."""
        if self._seconds > self._moved_at + KNOCKS_S:
            self._moved = 0
        self._moved += 1
        self._moved_at = self._seconds
        add_window(self._turn, window)

    def _begin(self):
        """Name the rest; start its capture or refuse it once."""
        mean = self._noise.mean
        face, off_deg = nearest_face(mean[0], mean[1], mean[2])
        last = self.placements[-1] if self.placements else None
        same = last and face_of_code(last.pose) == face and not self._away
        turned, saturated = 180.0, False
        if same and self.gyro_lsb_per_dps:
            saturated = self._turn.saturated
            turned = turned_deg(self._turn, self._noise.bias, self.gyro_lsb_per_dps, AXIS[face])
        elif last and face_of_code(last.pose) != face:
            self._away = True
        code = last.pose if same else 0
        if self.wanted:
            from sixflip.poses.pose_label import PlannedLabel  # most sessions have no plan

            if not self.gyro_lsb_per_dps:
                code = 0
            label = PlannedLabel(self.missing()[0], face, off_deg, code, turned, saturated)
        else:
            done = [p.pose for p in self.placements]
            label = PoseLabel(face, off_deg, code, done, turned, saturated)
        self._moved = 0
        self._rest_face = face
        if label.code == 0:
            self._rest_over()
            self._show_of(label)
            self.face = face
            return REFUSED
        self.state = "capturing"
        self.face = face_of_code(label.code)
        self.candidate = label.code
        self._pose = PoseSums(label.code, self.samples, self.windows)
        return WINDOW

    def _rest_over(self):
        """This rest is dealt with: wait until the box has moved."""
        self._idle()
        self._rested = True
        self.state = "moving"

    def _give_up_pose(self):
        if self._pose:
            absorb(self._log.open, self._pose.span)
        self._idle()

    def _capture(self):
        noise = self._noise
        pose = self._pose
        reason = noise.judge(self._window, LEAVE)
        if not reason:
            reason = pose.add(self._window, noise)
        if reason:
            if not pose.full():  # a full one has this window in already
                add_window(pose.span, self._window)
            self._give_up_pose()
            self._log.turn(self._window)
            self._moving(self._window)
            self.state = "moving"
            self._show_of(noise)
            return REFUSED
        self._show_of(noise)
        self.progress = pose.span.n
        if not pose.full():
            return WINDOW
        return self._accept(pose)

    def _accept(self, pose):
        if not self.wanted and self._log.drop(pose.pose):
            self.withdrawn.append(pose.pose)
        self._log.accept(pose.placement())
        means = pose.means()
        self._noise.bias = means[3:]
        self._noise.bias_fixed = True
        self._since = self._seconds
        self.left_s = self.timeout_s
        self._turn = empty_move(0)
        self._away = False
        self._rest_over()
        self._show("", 0, 0, "")
        if self.missing():
            return POSE
        self.state = "done"
        return COMPLETE
