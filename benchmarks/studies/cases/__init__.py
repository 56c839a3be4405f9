"""The paper's three test cases, and its claims about them.

runs.py (what is run), claims.py (the paper's numbers, rules and verdicts), accuracy.py (errors by
step), tables.py, figures.py (the paper's figures), page.py (doc/results.md and README's block).
"""
