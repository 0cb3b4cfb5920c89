"""What scatter of the input does to an impact: Sobol indices, and the ballistic limit as a probability.

`sobol` has the first and total order indices of velocity and peak tension over the uncertainties of the input (source
thesis chapter 6 varies three of them, one at a time). `v50` fires repeated shots at panels whose yarns differ in
strength, and `probit` fits V0, V50 and V100 to them. Ranges and spreads are in inputs.toml, each with its source.
"""
