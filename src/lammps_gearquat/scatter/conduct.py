"""A run of the command: settings, flights until the errors are small enough, and the results in their folder."""

from dataclasses import replace

from gearquat_analysis.units import UNITS

from .. import figures
from ..trials.script import DeckError
from . import flights, largest, report, store
from .pool import Pool
from .results import convergence, results
from .sampling import REPLICAS, Plan

#: flights before errors are looked at, which doubles as long as they are too large
FIRST_ROUND = 32 * REPLICAS
#: what may be left out beyond the largest impact parameter, by the error that is asked for
LEFT_OUT = 0.1


def scatter(scene, asked, numbers, error, most, out, progress):
    """Fly, and write the results into the folder ``out``; returns them as text.

    ``scene``: arguments of ``open_pair``; ``asked``: seed, temperature, energy, rotation, largest, most_steps,
    processes and sigma; ``numbers``, a range of flights, or None: until all relative standard errors are at most
    ``error``, or ``most`` flights; ``progress`` is a bar.  Raises DeckError and TrialError.
    """
    with Pool(scene, asked["processes"], asked["most_steps"]) as pool:
        progress.set_description("largest impact parameter")
        plan, wanted = _settle(pool, asked, error, out)
        store.begin(out, wanted)
        progress.set_description("flights")
        rows = _until(pool, plan, numbers, error, most, out, progress, asked["sigma"])
    text, others = conclude(out, wanted, rows, asked["sigma"]), numbers and len(rows) - len(numbers)
    if others:
        text += f"\n{others} of the {len(rows)} flights were in the folder before and are not among those asked for"
    return text


def _settle(pool, asked, error, out):
    """The Plan with its largest impact parameter, and the settings.

    If the folder has flights of the same settings, with an impact parameter that is large enough, it stays.
    """
    scale = asked["energy"]
    if scale is None:
        scale = UNITS[pool.facts.style].boltzmann * asked["temperature"]
    pool.check(scale)
    plan = Plan((asked["seed"],), asked["temperature"], asked["energy"], asked["rotation"], 0.0)
    allowed, steps = LEFT_OUT * error, asked["most_steps"]
    if (out / store.SETTINGS).exists():
        known = store.read_settings(out)
        _, _, farthest = store.facts_of(known)
        plan_then = replace(plan, largest=farthest.value, core=farthest.core)
        enough = farthest.left and max(farthest.left.values()) <= allowed
        if enough and not asked["largest"] and store.settings(pool.facts, plan_then, farthest, steps) == known:
            return plan_then, known
    if asked["largest"]:
        farthest = largest.given(pool.facts, asked["largest"])
    else:
        farthest = largest.find(pool, plan, scale, allowed)
    plan = replace(plan, largest=farthest.value, core=farthest.core)
    return plan, store.settings(pool.facts, plan, farthest, steps)


def _until(pool, plan, numbers, error, most, out, progress, sigma):
    """Rows of all flights of the folder, in their order, after those that were asked for."""
    lines = store.read_lines(out)
    known = {store.number_of(line): row for line, row in zip(lines, store.parse(lines))}
    last, ordered = max(known, default=-1), list(known) == sorted(known)
    with store.Writer(out) as writer:
        wanted = numbers or range(min(FIRST_ROUND, most))
        while True:
            missing = [number for number in wanted if number not in known]
            progress.total = progress.n + len(missing)
            for some in pool.fly(plan, missing):
                known |= {flight.flight: row for flight, row in zip(some, writer.append(some))}
                progress.update(len(some))
            ordered, last = ordered and (not missing or missing[0] > last), max(known)
            if numbers or len(wanted) >= most:
                break
            rows = [known[number] for number in wanted]
            if results(flights.columns(rows), plan, pool.facts, sigma).relative <= error:
                break
            wanted = range(min(2 * len(wanted), most))
    if not ordered:
        store.rewrite(out, known)
    return [known[number] for number in sorted(known)]


def conclude(out, settings, rows, sigma):
    """Write results.json and the pictures; the results as text."""
    facts, plan, farthest = store.facts_of(settings)
    columns = flights.columns(rows)
    found = results(columns, plan, facts, sigma)
    store.write_json(out / store.RESULTS, report.as_json(settings, found))
    figures.draw_deflection(out / "deflection.png", facts.name, columns, plan, UNITS[facts.style])
    figures.draw_convergence(out / "convergence.png", facts.name, *convergence(columns, plan, facts))
    return report.text(facts, plan, farthest, found)


def merge(parts, out, sigma):
    """Join the folders ``parts`` in ``out``; the results as text.  Raises DeckError."""
    settings, rows, notes = store.merge(parts, out)
    if sigma is not None and settings["plan"]["energy"] is not None:
        raise DeckError("the parts have one energy: --sigma, for collision integrals at a temperature, has to be left out")
    return "\n".join([conclude(out, settings, rows, sigma), *notes])
