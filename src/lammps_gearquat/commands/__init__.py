"""The commands of ``gearquat``: options and messages; the work is done elsewhere."""
