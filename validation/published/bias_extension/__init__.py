"""The bias extension test of balanced S-728 (thesis section 4.4.3, Figures 4-25 to 4-27).

A coupon of 143.5 x 74 mm, its yarns at 45 degrees to the load, is stretched by 5 mm at each end (erratum E-31: or
5 mm in all). Balanced means the mean crimp, 1.35 %, in both families (E-31). Yarns do not fail. The thesis's figures
show the three zones without numbers; compared is the angle of yarns that do not stretch, a closed form.

Four cloths: the trellis law as published; its soft modulus G1 at all angles; no trellis at all, which runs into bands;
and straight yarns with the soft modulus, the cloth for which the closed form is meant.
"""
