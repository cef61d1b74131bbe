"""What is read off the samples themselves, before any model of the sensor.

detection                          what is found: a sensor's effect, or a recording's damage
codes, torn_reads (sample_neighbours), saturation, dead_band (lattice), axis_order, sample_clock,
missing_rows                       registers and timing
byte_faults (course_likelihood), held_values (stuck_axes), unread_rows, row_order, wrong_scale
                                   damage: bytes, rows that repeat, that nobody read or that are
                                   out of order, full scales
spectral_lines (rest_spectra, line_frequency, line_across_rests, line_steadiness, line_wander),
noise_bursts, noise_shape, spikes (rest_parts), shake_detector
                                   lines of a spectrum, noise that changes, is shared or is not
                                   normal, single samples far off, what rings out after a move,
                                   hands, legs and vehicles
"""
