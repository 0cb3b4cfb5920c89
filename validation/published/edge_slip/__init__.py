"""Slip of cloth in its clamps: led edges as in thesis section 6.4.3, and slip that follows from a grip force."""
