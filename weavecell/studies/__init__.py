"""Studies of many shots, which compute and neither print nor write.

`limit` brackets the critical velocity and scans about it; `assumed_range` and `mesh_uncertainty`
say how far a result depends on laws that are assumed and on the mesh; `unknown` is what nobody gave,
which `strengths` draws with the yarns; `v50` fires at drawn panels, and `drawn` is what their
outcomes tell of the limit; `passing` is the share that passes at one velocity; `probit` fits V0, V50
and V100 to tests, `protocol` is a laboratory's short series; `inputs` has the ranges and spreads of
the input, each with its source (inputs.toml); `sweep` is a row of a table over keys, `paired` says
which of two panels has the higher V50, `laboratory_tests` reduces tests and puts computed shots
beside them.
"""
