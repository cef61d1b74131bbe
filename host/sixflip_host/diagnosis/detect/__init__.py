"""What is read off the samples themselves, before any model of the sensor.

detection, damage                  what is found: a sensor's effect, or a recording's damage
integrity                          registers and timing in their order; with
    codes, torn_reads (sample_neighbours), saturation, axis_order, sample_clock
byte_faults (course_likelihood), held_values, wrong_scale
                                   damage: bytes, rows that repeat, full scales
spectral_lines (line_frequency, line_across_rests), noise_bursts, shake_detector
                                   lines of a spectrum, bursts and spikes, hands and vehicles
"""
