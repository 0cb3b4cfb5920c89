"""Sliding crossovers of one ply: yarns slip through the nodes of a panel against friction."""
