"""Errors, units, schemas, files, caches and executors, which know no fabric."""
