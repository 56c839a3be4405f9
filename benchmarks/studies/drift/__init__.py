"""Energy over very long runs: runs.py (plan, logs, verdicts, text), figures.py (pictures)."""
