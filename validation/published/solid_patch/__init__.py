"""The third row of thesis Table 4-3: a 25.4 mm patch of solid yarns under impact, and the shell beside it."""
