"""Applied forces: gravity, springs, dampers, point loads."""
