"""Why the published solid constants of S-720 miss its platen curve: one factor at a time."""
