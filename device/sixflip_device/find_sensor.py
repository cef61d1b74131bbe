"""The sensor on a bus that may be stuck: probed, and configured."""


def find(board, settings, tries=3):
    """Probes and configures -> (imu, report). Raises the last OSError (NoChip: .report).

    The prober asks an ID again before it believes a wrong one; a stuck bus is freed here.
    """
    from sixflip.chips import probe

    from .bus_recovery import free_bus, sleeper

    for k in range(tries):
        try:
            imu, report = probe.find(board.i2c, sleeper(board), settings["sensor"],
                                    (settings["accel_range_g"], settings["gyro_range_dps"]))
            if settings["rate_hz"] > imu.MOST_HZ:
                report.append("%d samples a second are more than the %s is polled: %d are used"
                              % (settings["rate_hz"], imu.name, imu.MOST_HZ))
                settings["rate_hz"] = imu.MOST_HZ
            imu.configure(settings["rate_hz"])
            return imu, report
        except OSError as e:
            error = e
            if k + 1 < tries:
                board.sleep_us(20000)
                free_bus(board)
    raise error
