"""One engine for all studies.

A study is a module or a package of ``benchmarks/studies`` with a ``STUDY``, and a template for each block that it
writes into a page.  No other file has to be changed: ``benchmarks/run`` finds the study.

    from benchmarks.engine import Curve, Finding, Job, Measurement, Panel, Study, Table, deck

    STUDY = Study("cost", "Cost of a step", 180.0, measure, find, {"doc/accuracy.md": "cost.md.j2"})  # see study.py

``measure(lab)`` runs LAMMPS and returns plain data: numbers, arrays, dictionaries (their keys may be
tuples) and dataclasses of these.  It makes no judgments.  The data are kept as JSON, which names dataclasses
by their modules, and ``--render`` makes the blocks from them again.  So the ``Results``, ``Run`` and ``Plan``
of a study are its own, are used in its modules only, and keep their names.  The Lab (lab.py) runs decks:

    lab.sweep(name, deck, axes, read, settings)   every combination of values of variables -> read(finished)
    lab.many({name: Job(deck, variables, steps)}) side by side, --jobs at once -> {name: Finished}
    lab.in_turn(jobs, rounds)                     one at a time, for timing -> {name: [Finished, ...]}
    lab.quick, lab.hours                          the requested options

Where starting LAMMPS would take longer than the run, session.py keeps it in a process, times the ``run``
command alone, and repeats competitors in turn until their medians are steady.

``find(data)`` returns a Finding: measurements with uncertainties, tables, pictures and further names for
the template.  It runs nothing, so that tests can feed it data that must be refused.  A bound belongs to
its Measurement; ``--check`` compares with it, pages do not show it.  Pictures are tuples of Panels
(panels.py), or functions that draw into a path.  Statistics are in statistics.py.

Templates consist of sentences and of the definitions of page.py:

    {{ table("name") }}  {{ picture("name", "Caption.") }}
    {{ x | to(".1e") }}  {{ n | grouped }}
"""

from .decks import EXAMPLES, ROOT, deck  # noqa: F401
from .lab import Job, Lab  # noqa: F401
from .panels import Curve, Panel, draw  # noqa: F401
from .runner import LammpsError  # noqa: F401
from .study import Finding, Measurement, Study, Table  # noqa: F401
