"""The crossover cell: tensions of warp and weft as functions of both stretches, and the table of
them."""
