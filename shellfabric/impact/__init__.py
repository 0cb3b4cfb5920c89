"""Complete runs: the impact on one ply or on a pack, the ballistic limit, the Lambert-Jonas
curve."""
