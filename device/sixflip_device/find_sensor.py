"""The sensor on a bus that may be stuck: probed, and configured."""


def find(board, settings, tries=3):
    """Probes and configures -> (imu, report). Raises the last OSError (NoChip: .report).

    The prober asks an ID again before it believes a wrong one; a stuck bus is freed here.
    """
    from sixflip.chips import probe

    from .bus_recovery import free_bus, sleeper

    for k in range(tries):
        try:
            imu, report = probe.find(board.i2c, sleeper(board), settings["sensor"])
            imu.configure(settings["rate_hz"])
            return imu, report
        except OSError as e:
            error = e
            if k + 1 < tries:
                board.sleep_us(20000)
                free_bus(board)
    raise error
