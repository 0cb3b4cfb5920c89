"""Pencilling: light and heavy targets before a block of tissue simulant (thesis section 6.5, Tables 6-1 and 6-2)."""
