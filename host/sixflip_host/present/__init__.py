"""Words, pages and pictures: what a person reads of a capture, a plan or a gap."""
