"""The user's own simulator against the real sensor."""
