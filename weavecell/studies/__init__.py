"""Studies of many shots, which compute and neither print nor write.

`limit` brackets the critical velocity and scans about it; `assumed_range` and `mesh_uncertainty`
say how far a result depends on laws that are assumed and on the mesh; `interval` is an answer over
the `places` that a nose may strike and the frictions that nobody gave; `v50` fires at panels whose
yarns differ in strength (`strengths`), `probit` fits V0, V50 and V100, `protocol` is a laboratory's
short series; `inputs` has the ranges and spreads of the input, each with its source (inputs.toml);
`sweep` is a row of a table over keys, `paired` says which of two panels has the higher V50,
`laboratory_tests` reduces tests and puts computed shots beside them.
"""
