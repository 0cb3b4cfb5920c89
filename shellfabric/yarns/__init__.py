"""A zone of resolved yarns about the nose, tied to the membrane of a panel."""
