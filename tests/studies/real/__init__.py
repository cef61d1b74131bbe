"""Every claim on real recordings beside a plain computation: `make real`."""
