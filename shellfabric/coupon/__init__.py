"""Quasi-static coupons by dynamic relaxation: uniaxial, biaxial, bias extension, picture frame."""
