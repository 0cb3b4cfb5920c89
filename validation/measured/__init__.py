"""What was measured of fabrics, held against what the models compute.

rows.csv        a row a measured number: where it stands, its sigma, what is assumed, and how it is computed
inputs/         the set-ups of these rows as input files, written before a row was computed
"""
