"""Simulators' documented bugs on MuJoCo's motion, and whether they are named: `make zoo`."""
