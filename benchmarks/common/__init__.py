"""What the benchmarks share: timing in turn, tables, targets, the machine."""
