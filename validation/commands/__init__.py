"""The programs of `python -m validation`: cost against error, stability, claims, calibration of the catalogue."""
