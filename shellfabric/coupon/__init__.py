"""Coupons: quasi-static by dynamic relaxation (uniaxial, biaxial, bias extension, picture frame);
yarn pull-out."""
