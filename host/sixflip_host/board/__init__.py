"""A board at the end of a cable, or firmware on this machine: find, provision, guide, pull."""
