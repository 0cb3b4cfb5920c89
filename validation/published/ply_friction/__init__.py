"""Friction between the plies of a pack: its effect on the first failure and on the ballistic limit."""
