"""Material laws of other codes for a fabric, and their error.

fabric     the cell as a membrane: nominal stresses, curves, the biaxial plane
laws      the laws, made from a fabric and evaluated by the codes' own equations
mismatch  a law less the cell
"""
