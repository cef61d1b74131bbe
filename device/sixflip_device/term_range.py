"""Said when the temperature leaves the range that a record's terms were measured in."""


def teller(unit):
    """What TermCorrection calls, once."""
    def tell(temp_c, low_c, high_c):
        unit.events.emit("term_range", temp_c=temp_c, low_c=low_c, high_c=high_c,
                         note="outside of what the terms were measured at; the edge holds")
    return tell
