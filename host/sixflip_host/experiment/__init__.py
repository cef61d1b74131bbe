"""A capture as an experiment: what plan, diagnose, refine and verify share.

blocks, session (block_measures, thermometer, way_memory)
                          a capture cut into rests and moves; what is measured of each part
attitude_fit              which way each placement lay
turns, inertial_fit       how the gyro turned in a move, and what the accelerometer read in it
long_rest                 rests in one attitude
nominal_rows, covariance
                          rest readings as rows: what is unknown in them, and how they err
terms, session_terms      the columns of every effect, and its variants that rests can show
linear_model (gram, factored_gram)
                          rows and columns reduced to what all later questions need
projection, signal_measures, noise_arrays, low_pass
                          least squares on columns, measures of recordings, noise, and low-passes
"""
