"""All hard cases, in the order of the page."""

from . import fine, poles, tumbling

CASES = (fine.CASE, poles.CASE, tumbling.CASE)
