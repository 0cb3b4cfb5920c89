"""Models that the product is compared with, and that no command or key of an input file reaches."""
