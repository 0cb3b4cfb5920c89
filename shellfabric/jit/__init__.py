"""What compiled code needs: tables of arrays, units of compilation, SIMD type, thread barrier,
aligned arrays."""
