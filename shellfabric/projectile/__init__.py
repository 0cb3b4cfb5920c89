"""The projectile: shapes as signed distances, rigid or elastic bar, contact with the fabric,
friction."""
