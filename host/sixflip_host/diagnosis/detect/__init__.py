"""What needs no statistics over poses: registers, the clock, the axes, lines, spikes."""
