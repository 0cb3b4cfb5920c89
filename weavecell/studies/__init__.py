"""Studies of many shots, which compute and neither print nor write.

`limit` brackets the critical velocity and scans about it; `assumed_range` and `mesh_uncertainty`
say how far a result depends on laws that are assumed and on the mesh; `unknown` is what nobody gave,
which `strengths` draws with the yarns; `protocol` is the V50 of six shots; `inputs` has the ranges and
spreads of the input, each with its source (inputs.toml).
"""
