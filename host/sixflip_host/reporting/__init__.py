"""Pages and pictures to look at: one file each, nothing to fetch, nothing to run."""
