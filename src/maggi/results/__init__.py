"""Results of a run: kept in a file or in memory, read through one interface, summed up, exported."""
