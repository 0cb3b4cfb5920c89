"""What compiled code needs: compilation options, SIMD type, thread barrier, borrowed references, aligned arrays."""
