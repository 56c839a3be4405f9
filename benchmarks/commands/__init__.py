"""The commands of ``benchmarks/run``: options and messages; the work is done elsewhere."""
