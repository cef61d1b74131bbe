"""What a capture's header says of the sensor, registers as read back; needed once a session.

It imports no driver: a small board has let go of their modules by then.
"""

ATTEMPTS = 3


def metadata(imu):
    """CAPTURE.md's keys, of any of the drivers."""
    accel = getattr(imu, "accel", imu)  # a GY-85 is two chips
    answer = {"sensor": imu.sensor, "name": imu.name, "who_am_i": list(imu.who_am_i),
              "rate_hz": imu.rate_hz, "filter_hz": accel.filter_hz,
              "output_rate_hz": accel.output_rate_hz, "registers": _read_back(accel, "")}
    for name in ("accel_lsb_per_g", "accel_range_g", "gyro_lsb_per_dps", "gyro_range_dps",
                 "temp_lsb_per_c", "temp_offset_c"):
        if getattr(imu, name) or name == "temp_offset_c" and imu.has_temp:
            answer[name] = getattr(imu, name)
    if accel is not imu:
        answer["registers"].update(_read_back(imu.gyro, "gyro "))
    return answer


def _read_back(chip, prefix):
    """What scales and shifts; what a failing bus does not give in ATTEMPTS is left out."""
    registers = {}
    for r in [first + i for first, n in chip.setup + chip.offsets for i in range(n)]:
        for _ in range(ATTEMPTS):
            try:
                registers[prefix + "0x%02x" % r] = chip._read(r)
                break
            except OSError:
                continue
    return registers
