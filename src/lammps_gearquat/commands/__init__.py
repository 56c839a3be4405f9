"""The commands of ``gearquat``: options and messages; other modules do the work."""
