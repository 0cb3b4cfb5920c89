"""One ply of six fabrics: critical and residual velocities, histories, back-face profiles, waves, reactions."""
