"""The IMU in a PX4 log: sensor_combined, or sensor_accel or sensor_gyro where that is all."""

from ... import sample_limit
from ...errors import BadFile
from ...optional import need
from .arrays import ArrayTable

MAGIC = b"ULog\x01\x12\x35"
AXES = range(3)
# Topic: columns of theirs. PX4's messages say m/s² and rad/s, microseconds since boot.
TOPICS = {
    "sensor_combined": ["accelerometer_m_s2[%d]" % k for k in AXES]
    + ["gyro_rad[%d]" % k for k in AXES],
    "sensor_accel": ["x", "y", "z"],
    "sensor_gyro": ["x", "y", "z"],
}
NAMED = {"sensor_accel": "accel_%s", "sensor_gyro": "gyro_%s"}


def read_ulog(path, topic=None):
    """ArrayTable of one topic of a ULog."""
    pyulog = need("a PX4 log", "data", "pyulog")
    try:
        with sample_limit.little_memory():
            log = pyulog.ULog(str(path), list(TOPICS))
    except MemoryError:
        raise BadFile("%s: its messages need more than %d MB, expected less, or --limit with the "
                      "number of samples there may be" % (path, sample_limit.memory() >> 20)) \
            from None
    except Exception as error:      # a library that is fed with whatever the file holds
        raise BadFile("%s: is no ULog or a damaged one: %s" % (
            path, (str(error) or type(error).__name__).splitlines()[0][:200])) from None
    there = {data.name: data.data for data in log.data_list if data.multi_id == 0
             and data.name in TOPICS}
    chosen = topic or next((name for name in TOPICS if name in there), None)
    if chosen not in there:
        raise BadFile("%s: %s in it, expected %s" % (
            path, "no topic %s" % topic if topic else "no readings of an IMU",
            " or ".join(there or TOPICS)))
    data = there[chosen]
    absent = [name for name in ["timestamp", *TOPICS[chosen]] if name not in data]
    if absent:
        raise BadFile("%s: its %s has no %s, expected %s" % (
            path, chosen, absent[0], " ".join(TOPICS[chosen])))
    columns = {"timestamp_us": data["timestamp"]}
    for name in TOPICS[chosen]:
        columns[NAMED.get(chosen, "%s") % name] = data[name]
    if chosen == "sensor_accel" and "temperature" in data:
        columns["temperature"] = data["temperature"]
    return ArrayTable(path, columns, {"a": "m/s2", "g": "rad/s"})
