"""One folder per study: its runs and their evaluation."""
