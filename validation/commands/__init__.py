"""The program of the claims, of `python -m validation`."""
