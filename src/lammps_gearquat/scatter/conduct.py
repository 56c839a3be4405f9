"""A run of the command: settings, flights until the errors are small enough, and the results in their folder."""

from dataclasses import replace

from gearquat_analysis.units import UNITS

from .. import figures
from ..trials.script import DeckError
from . import flights, pilots, report, store
from .pool import Pool
from .results import convergence, results
from .sampling import REPLICAS, Plan

#: number of flights after which errors are checked; it doubles as long as they are too large
FIRST_ROUND = 32 * REPLICAS
#: allowed loss beyond the largest impact parameter, in units of the requested error
LEFT_OUT = 0.1


def scatter(scene, asked, numbers, error, most, out, progress):
    """Simulate flights, and write the results into the folder ``out``; returns them as text.

    ``scene``: arguments of ``open_pair``; ``asked``: as in ``simulate``, with processes, most_steps and sigma; the
    others as in ``simulate``.  Raises DeckError and LammpsError.
    """
    with Pool(scene, asked["processes"], asked["most_steps"]) as pool:
        wanted, rows = simulate(pool, asked, numbers, error, most, out, progress)
    text, others = conclude(out, wanted, rows, asked["sigma"]), numbers and len(rows) - len(numbers)
    if others:
        text += f"\n{others} of the {len(rows)} flights were in the folder before and are not among those asked for"
    return text


def simulate(pool, asked, numbers, error, most, out, progress):
    """Simulate flights in a Pool and keep them in the folder ``out``; (settings, rows of all flights there).

    ``asked``: seed, temperature (a rising tuple), energy, rotation and largest; ``numbers``, a range of flights, or None:
    until all relative standard errors are at most ``error``, or ``most`` flights; ``progress``: what has the methods begin, advance and tell of commands/scatter.py.
    """
    plan, farthest, wanted = _settle(pool, asked, error, out, progress)
    if not numbers:
        _reachable(farthest, error, asked["largest"])
    store.begin(out, wanted)
    return wanted, _until(pool, plan, farthest, numbers, error, most, out, progress)


def _settle(pool, asked, error, out, progress):
    """(Plan, Largest, settings), from pilot flights.

    If the folder has flights of the same settings with a largest impact parameter that is sufficient, this value is
    kept.
    """
    boltzmann = UNITS[pool.facts.style].boltzmann
    plan = Plan((asked["seed"],), asked["temperature"], asked["energy"], asked["rotation"], 0.0)
    pool.check(plan.scales(boltzmann)[0])
    allowed, steps = LEFT_OUT * error, pool.most_steps
    if (out / store.SETTINGS).exists():
        known = store.read_settings(out)
        _, then, farthest = store.facts_of(known)
        same = {name: getattr(then, name) for name in ("largest", "s0", "s1", "power")}
        if asked["largest"]:
            enough = then.largest == asked["largest"]
        else:
            enough = farthest.highest() is not None and farthest.highest() <= allowed
        if enough and store.settings(pool.facts, replace(plan, **same), farthest, steps) == known:
            return then, farthest, known
    if asked["largest"]:
        pilots.within_cutoff(pool.facts, asked["largest"])
    progress.begin("pilot flights", pilots.number_of(plan, boltzmann))
    places, columns = pool.pilots(plan, progress.advance)
    plan, farthest = pilots.settle(plan, pool.facts, places, columns, boltzmann, allowed, asked["largest"])
    return plan, farthest, store.settings(pool.facts, plan, farthest, steps)


def _reachable(farthest, error, given):
    """Raise DeckError if the requested error cannot be reached because --largest leaves out too much."""
    left = max((one["momentum"] or 0.0) for one in farthest.left)
    left = max(left, *((one["viscosity"] or 0.0) for one in farthest.left))
    if given and left >= error:
        raise DeckError(
            f"--largest {given:g}: {left:.1e} of the loss is beyond it, so errors cannot be as small as {error:g} with any number"
            f" of flights; a larger --largest is required, or --count, the number of flights"
        )


def rounds(most):
    """Numbers of flights after which errors are checked."""
    number = min(FIRST_ROUND, most)
    while number < most:
        yield number
        number = min(2 * number, most)
    yield number


def _until(pool, plan, farthest, numbers, error, most, out, progress):
    """Rows of all flights of the folder, in their order, after the requested flights have been simulated."""
    lines = store.read_lines(out)
    known = {store.number_of(line): row for line, row in zip(lines, store.parse(lines))}
    last, ordered = max(known, default=-1), list(known) == sorted(known)
    with store.Writer(out) as writer:
        for wanted in [numbers] if numbers else map(range, rounds(most)):
            missing = [number for number in wanted if number not in known]
            progress.begin("flights", len(missing), len(wanted) - len(missing))
            for some in pool.fly(plan, missing):
                known |= {flight.flight: row for flight, row in zip(some, writer.append(some))}
                progress.advance(len(some))
            ordered, last = ordered and (not missing or missing[0] > last), max(known)
            if numbers:
                break
            columns = flights.columns([known[number] for number in wanted])
            found = results(columns, plan, pool.facts, left=farthest.left)
            progress.tell(report.so_far(found, error))
            if found.relative <= error:
                break
            _finished(found, error)
    if not ordered:
        store.rewrite(out, known)
    return [known[number] for number in sorted(known)]


def _finished(found, error):
    """Raise DeckError if the errors exceed the requested errors because of unparted flights."""
    if found.guessed > error:
        raise DeckError(
            f"{report.unfinished(found)}; they are {found.guessed:.1e} of the averages, more than --error {error:g}, and no"
            " number of flights changes that: more --steps are required, with another --out"
        )


def conclude(out, settings, rows, sigma):
    """Write results.json and the pictures; the results as text."""
    facts, plan, farthest = store.facts_of(settings)
    columns = flights.columns(rows)
    found = results(columns, plan, facts, sigma, farthest.left)
    store.write_json(out / store.RESULTS, report.as_json(settings, found))
    figures.draw_deflection(out / "deflection.png", facts.name, columns, plan, UNITS[facts.style])
    shown = {
        report.condition(temperature, facts.style): convergence(columns, plan, facts, temperature)
        for temperature in dict.fromkeys((plan.conditions[0], plan.conditions[-1]))
    }
    figures.draw_convergence(out / "convergence.png", facts.name, shown)
    return report.text(facts, plan, farthest, found)


def merge(parts, out, sigma):
    """Join the folders ``parts`` in ``out``; the results as text.  Raises DeckError."""
    settings, rows, notes = store.merge(parts, out)
    if sigma is not None and settings["plan"]["energy"] is not None:
        raise DeckError("the parts have one energy: --sigma, for collision integrals at a temperature, has to be left out")
    return "\n".join([conclude(out, settings, rows, sigma), *notes])
