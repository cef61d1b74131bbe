"""The sensor on a bus that may be stuck: probed, and configured."""

POLLED_HZ = 125  # the longest turn of a session's loop takes a Pico 7 ms: the bench instructions


def by_fifo(imu, rate_hz, wanted, report):
    """Samples come through the chip's FIFO where a board that polls would miss some, and where
    the settings want it; they may not."""
    if wanted is False or wanted is None and rate_hz <= POLLED_HZ:
        return
    if getattr(imu, "FIFO", ""):
        imu.use_fifo()
    elif wanted:
        report.append("the %s has no FIFO that is used: it is polled" % imu.name)


def find(board, settings, tries=3):
    """Probes and configures -> (imu, report). Raises the last OSError (NoChip: .report).

    The prober asks an ID again before it believes a wrong one; a stuck bus is freed here.
    """
    from sixflip.chips import probe

    from .sensor import free_bus, sleeper

    for k in range(tries):
        try:
            imu, report = probe.find(board.i2c, sleeper(board), settings["sensor"],
                                    (settings["accel_range_g"], settings["gyro_range_dps"]))
            if settings["rate_hz"] > imu.MOST_HZ:
                report.append("%d samples a second are more than the %s is polled: %d are used"
                              % (settings["rate_hz"], imu.name, imu.MOST_HZ))
                settings["rate_hz"] = imu.MOST_HZ
            by_fifo(imu, settings["rate_hz"], settings["fifo"], report)
            imu.configure(settings["rate_hz"])
            if imu.rate_hz != settings["rate_hz"]:
                report.append("%d samples a second are not a rate of the %s: %d are taken"
                              % (settings["rate_hz"], imu.name, imu.rate_hz))
                settings["rate_hz"] = imu.rate_hz
            return imu, report
        except OSError as e:
            error = e
            if k + 1 < tries:
                board.sleep_us(20000)
                free_bus(board)
    raise error


def run(firmware):
    """The phase after a calibration: for the seconds of a solve nobody has read the sensor, so
    it is identified and set up anew. BusLost where it is gone or is another one."""
    from .sensor import BusLost, Sensor
    try:
        imu = find(firmware.board, firmware.settings)[0]
    except OSError as e:
        raise BusLost(str(e)) from e
    firmware.sensor = Sensor(firmware.board, imu, firmware.settings, firmware.events)
