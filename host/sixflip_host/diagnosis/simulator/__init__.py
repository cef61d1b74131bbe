"""The user's own simulator beside the real sensor: which conventions, numbers and effects differ.

traces, log_rests, rest_or_course, row_times, single_log, log_noise, held_readings
                                   what one log says of itself
alignment, motion_match, lag_path, clock_course, pairing, transfer
                                    two logs of one motion on one clock and one grid, and behind
                                    one low-pass
one_motion, hypotheses, own_effects, sensor_axes, evidence_of_logs, conventions,
convention_findings
                                   layer 1: what the simulator's numbers mean, by the same motion
own_rests, own_calibration, turned_in_box, own_motion, own_consistency, gravity_directions
                                   layer 1 where the motions differ: each log by its own rests
parameters, timing, stopping, noise_and_registers, noise_band, shaking, numbers_told
                                   layer 2: the numbers to set, and what they close of the gap
against_simulator, shaken_alike, dead_zone, lacking_effects, lacking_courses, effects_beside
                                   layer 3: the effects that one has and the other lacks
remaining_gap                      layer 4: what is left of the gap, and what it does to a robot
comparison, simulator_answer       all layers in their order, and the JSON of them

Thresholds that neither a data sheet nor a formula gives trade names that are found for healthy
simulators that are accused; `make zoo` prints both.
"""
