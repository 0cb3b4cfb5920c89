"""Convergence, stability, and cost against accuracy: what the methods do, whatever the literature says."""
