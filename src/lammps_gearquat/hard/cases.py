"""All hard cases, in the order of the page."""

from . import boundaries, cutoff, fast, fine, inertia, lifecycle, newstep, poles, tumbling

CASES = (
    fine.CASE,
    poles.CASE,
    tumbling.CASE,
    inertia.CASE,
    fast.CASE,
    newstep.CASE,
    lifecycle.CASE,
    boundaries.CASE,
    cutoff.CASE,
)
