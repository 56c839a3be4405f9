"""Reference solutions of rigid-body motion, independent of the fix, to judge errors of 1e-12.

This package shares no code with the fix or the scene generator.  Everything works in NumPy's long
double.  Contents and use::

    from benchmarks.reference import (
        Cage, FreeField, State, Problem, paper_problem, bodies_from_sites,
        reference_state, reference_states,
    )
    from benchmarks.reference.lammps_forces import LammpsForces, deck_problem, DeckError
    from benchmarks.reference.solvers import solve, state_errors
    from benchmarks.reference import splittings

    problem = paper_problem(1, "consistent")         # the cage; or case 3, or "unrotated"
    problem = deck_problem("in.water", {"dt": 0.5})  # any script; every molecule a rigid body
    top = problem.with_field(FreeField())            # the same bodies and start, no forces

    # State in long double: exact without forces, else by extrapolation
    end = reference_state(problem, 200.0)
    end.center, end.velocity, end.q, end.omega_body  # (B, 3) (B, 3) (B, 4) (B, 3)
    end.double                                       # the same as float64
    a, b = reference_states(problem, [100.0, 200.0]) # several times, one integration

    # sites (S, 3), unwrapped, to compare with a dump; their atom IDs in a deck_problem
    problem.site_positions(end), problem.field.ids

    # center (B,), angle (B,), energy (one number)
    errors = state_errors(problem, end, other_state)
    other_state, evaluations = solve(problem, 200.0, "DOP853", 1e-8)  # or "LSODA"
    # the same of splittings with exact free rotation, by their numbers of steps
    ((other_state, evaluations),) = splittings.states(problem, 200.0, splittings.SPLITTINGS[1], 1000)

State of a body: center of mass and velocity in space axes; q in the paper's order (vector part
first, scalar last; A(q) of Eq. 8 turns space into body axes); omega_body along the principal axes,
radians per unit of time.  Units follow the field.  The order and directions of the principal axes depend on how a
problem was made: compare q within one problem, sites between two.

Files: quaternion.py; equations.py (bodies, state, rates, energies); fields.py (cage, none);
lammps_forces.py (LAMMPS' own forces); paper.py (the paper's body and starts); integrators.py
(Gragg-Bulirsch-Stoer); free_top.py (exact); solvers.py (errors; solvers that
control their steps); multistep.py (symmetric, order 8); splittings.py (exact free rotation between kicks);
stability.py (stable steps of the methods of the fix for a linear equation); deflection.py (collisions
of two atoms).
"""

from .equations import Problem, RigidBodies, State, bodies_from_sites
from .fields import Cage, FreeField
from .integrators import reference_state, reference_states
from .paper import paper_problem

__all__ = [
    "Cage",
    "FreeField",
    "Problem",
    "RigidBodies",
    "State",
    "bodies_from_sites",
    "paper_problem",
    "reference_state",
    "reference_states",
]
