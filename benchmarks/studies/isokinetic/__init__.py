"""Constant kinetic energy: runs.py (plan, logs), judge.py (verdicts), figures.py, page.py."""
