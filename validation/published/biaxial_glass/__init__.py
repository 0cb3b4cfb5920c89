"""The biaxial tests of Buet-Gautier and Boisse on two glass weaves (thesis section 5.3, Tables 5-3 and 5-4).

A cross-shaped specimen is stretched along warp and weft at a fixed ratio k of the two strains, and the tension per
yarn is recorded. The thesis fits the compression law to k = 1 and predicts k = 0.5, k = 2 and the free edge. Its
measured points stand in figures that we do not have, so that nothing here is compared with a measurement: the curves
are those that the thesis's own parameters give, to be held beside a user's data.
"""
