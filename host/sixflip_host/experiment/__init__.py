"""A capture as an experiment: its blocks, their linear model, terms and covariance."""
