"""One folder a study: what it runs, and what it makes of that."""
