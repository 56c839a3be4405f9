"""Pictures of the paper's scene for talks: an orbit, the tumbling body, the energy, and a film.

``scenes`` runs LAMMPS and analyses its dumps; ``view`` projects and draws spheres; ``figures`` and ``film`` make
the files; ``page`` puts them into a checkout.
"""
