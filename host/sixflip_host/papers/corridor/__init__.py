"""Li's section 5 simulated: a robot drives around a looped corridor, and a SLAM engine maps it."""
