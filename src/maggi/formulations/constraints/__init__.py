"""Every liaison a second time, by its geometry alone: what it locks, and the forces by which it does so."""
