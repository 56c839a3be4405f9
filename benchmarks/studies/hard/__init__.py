"""Hard cases: scenes with an exact or independent answer, and whether the fix gives it.

``case.py`` what a case is; ``cases.py`` the list of them; ``runs.py`` LAMMPS; ``page.py`` tables and
page; ``figures.py`` pictures.  Every other module is one case, its decks are those of
``examples/hard/KEY``.
"""
