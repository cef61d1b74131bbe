"""A Raspberry Pi Pico without hardware: its own firmware image, instruction by instruction."""
