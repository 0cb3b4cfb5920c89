"""The solid law of a yarn and its fibre bars."""
