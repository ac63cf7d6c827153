"""Model ─► System: bodies, liaisons and forces on one vector of velocities."""
