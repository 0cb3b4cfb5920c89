"""One ply as a membrane of yarns: its grid, arrays, edges and time step; element forces, bending,
packing, failure, motion, quality indicators."""
