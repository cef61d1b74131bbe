"""The gap between a nominal simulated sensor and a real one: where it lies, what makes it.

diagnose, settings, diagnosis     the way in, what is asked for, the stages in their order
samples_judged (detect)           first stage: registers, clock and spectra
rests_judged                      second and third: rests, turns and moves, by these models:
rest_model, sensor_gap (box_tilt_test, between_sessions, wandering)
                                  a sensor at rest in its poses
turn_model (stray_turns)          the gyro in the turns between them
motion_model (moves_fit, moves_unit)
                                  both sensors in the moves
rest_gap (rest_units, rest_forms, sway), rest_noise
                                  one attitude only, or no poses
hypotheses (strangers, session_strangers, discrepancy)
                                  what competes: effects, what has no name, other forms
evidence (elimination, forms_at_once), scored_sets, posterior
                                  how likely sets of them are, and the likeliest
odds, cutoffs (mimicry)           probabilities, the verdict, and what a member costs
members, aliases, effect_estimates
                                  of each member: axes, variants, names that do as well, size
adequacy, localisation            what is left, and where it lies
holdout_gain, gap_figures         what is closed on what was held out, and by what
answer                            the JSON
closed_loop, closed_loops         the simulator run again with what was found
correction_terms, term_gain       what was found as terms of a board's record
simulator                         the user's own simulator beside the sensor

One thread for the linear algebra, which is settled here, before anything loads numpy. Matrices of
a few hundred rows gain nothing from more, and threads that spin while they wait for each other
take ten times as long on a machine that has something else to do. What runs side by side are whole
sensors, and spectra, in copies of the process, see side_by_side.py. A setting of the user's own is
kept.
"""
import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")
