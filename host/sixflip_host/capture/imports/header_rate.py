"""The rate in an imported capture's header: as it was stated, or measured from its times."""

from ...errors import BadFile
from .. import clock, clock_words


def told(path, options, columns, t_us, spread):
    """({rate_hz and whether it was measured, how far apart stamps were that rows shared},
    sentences on the clock); columns: of the times, or None; spread: time_stamps.Spread or None.
    BadFile where nothing tells."""
    if options.rate is not None and (columns is None or options.time_unit == "samples"):
        return {"rate_hz": options.rate, "rate": "stated"}, []
    measured, words = clock.measure(t_us), []
    if measured is None:
        if options.rate is None:
            raise BadFile("%s: the times do not say the rate, expected times that run, or "
                          "--rate HZ" % path)
    else:
        if spread is not None:      # when a new stamp begins is known to a row
            measured = clock.of_stamps(measured, spread.step_us, 1.0 / spread.between)
        words = clock_words.words(measured)
    step = {} if spread is None else {clock.STAMP_STEP: spread.step_us}
    if options.rate is not None:
        return {"rate_hz": options.rate, "rate": "stated", **step}, words
    return {**clock.header(measured), **step}, words
