"""The same flights by other methods: cost of a flight, and its largest energy error."""

import time

import numpy as np


from .flown import DECKS, encounter_of, packed

DECK, TEMPERATURE, LARGEST = "in.dumbbells", 2.0, 3.5
#: steps between two checks of the distance, as in the command
LOOK = 20
#: samples of the energy in a flight with a fixed step
SAMPLES = 2000
#: force evaluations of the start of fix gear/quat in free flight
START = 2


class Driver:
    """Flights of one deck in one LAMMPS, by fix gear/quat or another fix with a fixed step."""

    def __init__(self, pair):
        self.pair, self.encounter = pair, encounter_of(DECK, pair)
        self.end = 0.0

    def fly(self, start, fix, step, every, look=lambda: None):
        """Number of steps of the flight from a Start; ``look()`` is called every ``every`` steps."""
        pair, command = self.pair, self.pair.lammps.command
        command(f"unfix {pair.line.id}")
        command("reset_timestep 0 time 0.0")
        omega = pair._place(start)
        command(f"timestep {step or pair._first_step(start, omega):.17g}")
        command(fix)
        command(f"run {every} post no")
        # views of LAMMPS' arrays, which are not reallocated because no atom leaves
        positions, velocities = (self._local(name) for name in "xv")
        steps, run = every, f"run {every} pre no post no"
        while True:
            look()
            (one, two), (v_one, v_two) = pair.weights @ positions, pair.weights @ velocities
            away = two - one
            if away @ away >= pair.reach**2 and away @ (v_two - v_one) > 0.0:
                self.end = pair.lammps.get_thermo("time")
                return steps
            command(run)
            steps += every

    def _local(self, name):
        return self.pair.lammps.numpy.extract_atom(name)[: len(self.pair.bodies.index)]

    def energy(self):
        """Energy of the sites from LAMMPS, with an independent potential."""
        bodies = self.pair.bodies
        x, v = (self._local(name)[bodies.index] for name in "xv")
        apart = x[bodies.of == 1][None] - x[bodies.of == 0][:, None]
        r = np.sqrt((apart * apart).sum(axis=2))
        potential = sum(term.terms(r)[0].sum() for term in self.encounter.forces)
        return potential + 0.5 * self.encounter.factor * (bodies.masses[:, None] * v * v).sum()

    def cost(self, starts, fix, step=None):
        """(seconds, evaluations, error): means of the first two over the starts, and the median of the largest energy
        errors relative to the initial energy."""
        before, evaluations = time.process_time(), 0
        for start in starts:
            evaluations += self.fly(start, fix, step, LOOK) + START
            if step is None:
                evaluations += int(self.pair.lammps.extract_fix(self.pair.line.id, 0, 1, 15))
        seconds = time.process_time() - before
        errors = []
        for start in starts:
            energies, first = [], self.encounter.energy(packed(start))
            every = 1 if step is None else max(1, int(self.end / step / SAMPLES))
            self.fly(start, fix, step, every, lambda: energies.append(self.energy()))
            errors.append(np.abs(np.array(energies) - first).max() / first)
        return seconds / len(starts), evaluations / len(starts), float(np.median(errors))

    def cost_of_solver(self, starts, ends, method, tolerance):
        """The same for a solver of SciPy with the forces of encounters.py."""
        seconds, errors, self.encounter.evaluations = 0.0, [], 0
        states = []
        for start, end in zip(starts, ends):
            before = time.process_time()
            states.append(self.encounter.fly(packed(start), end, method, tolerance))
            seconds += time.process_time() - before
        evaluations = self.encounter.evaluations / len(starts)
        for path in states:
            energies = np.array([self.encounter.energy(state) for state in path])
            errors.append(np.abs(energies - energies[0]).max() / energies[0])
        return seconds / len(starts), evaluations, float(np.median(errors))


def points(count, tolerances, steps, solvers, tick):
    """Label -> array (settings, 3) of ``Driver.cost``.  ``solvers``: name -> tolerances; ``steps``: fixed steps."""
    from lammps_gearquat.scatter.pair import open_pair
    from lammps_gearquat.scatter.sampling import Plan

    found = {}
    with open_pair(DECKS / DECK) as pair:
        driver, plan = Driver(pair), Plan((3,), (TEMPERATURE,), None, None, LARGEST)
        starts = [start for _, _, start in plan.starts(pair, range(count))]
        name, ends = pair.line.id, []
        for start in starts:
            driver.fly(start, f"fix {name} all gear/quat molecule tolerance 1e-9 energy report no", None, LOOK)
            ends.append(driver.end)
        gear, rigid = "all gear/quat molecule tolerance {} energy report no", "all rigid/nve/small molecule"
        runs = [("fix gear/quat", f"fix {name} {gear.format(eps)}", None) for eps in tolerances]
        runs += [("fix rigid/nve/small", f"fix {name} {rigid}", step) for step in steps]
        for label, fix, step in runs:
            found.setdefault(label, []).append(driver.cost(starts, fix, step))
            tick()
        for label, own in solvers.items():
            for tolerance in own:
                found.setdefault(label, []).append(driver.cost_of_solver(starts, ends, label, tolerance))
                tick()
    return {label: np.array(rows) for label, rows in found.items()}
