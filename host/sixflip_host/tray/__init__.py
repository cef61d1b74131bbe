"""Several boards in one jig, calibrated together: one guidance, each with its own verdict."""
