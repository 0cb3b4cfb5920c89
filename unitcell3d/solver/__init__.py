"""Newton's method, load stepping, path following, records."""
