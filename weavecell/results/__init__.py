"""Records of runs: HDF5, summary.json, ParaView files, provenance."""
