"""All hard cases, in the order of the page."""

from . import (
    boundaries,
    cutoff,
    encounter,
    fast,
    fine,
    inertia,
    lifecycle,
    long,
    newstep,
    poles,
    tumbling,
)

MODULES = (
    encounter,
    long,
    fine,
    poles,
    tumbling,
    inertia,
    fast,
    newstep,
    lifecycle,
    boundaries,
    cutoff,
)
CASES = tuple(module.CASE for module in MODULES)
