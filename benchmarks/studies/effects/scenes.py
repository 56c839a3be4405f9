"""Scenes that differ by one effect: equal bodies on a cubic lattice.  Units: metal."""

from dataclasses import dataclass

from benchmarks.engine.methods import DEFAULT_VALUES

#: sites of a body in Angstrom, and their charges; all masses are equal
SHAPES = {
    "point": [(0.0, 0.0, 0.0)],
    "linear": [(-1.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.9, 0.0, 0.0)],
    "triangle": [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.2, 0.1)],
}
CHARGES = {1: [0.0], 3: [-0.4, 0.1, 0.3]}
SPACING = 5.0

_DECK = """\
units metal
atom_style {scene.style}
atom_modify map array sort 0 0.0
boundary {scene.boundary}
lattice sc {spacing}
region box block 0 {side} 0 {side} 0 {side}
create_box 1 box
molecule body molecule.{scene.shape}
lattice sc {spacing} origin {origin} {origin} {origin}
create_atoms 0 box mol body 4711
mass 1 12.0
{scene.before}
velocity all create 300.0 4711 loop geom
{forces}
neigh_modify exclude molecule/intra all every 100000 delay 0 check no
timestep 0.0005
fix move all gear/quat molecule report no {method} {scene.words}
{scene.after}
thermo_style custom step {scene.columns}
thermo {every}
run 1
run {steps}
"""

_FORCES = {
    "none": "pair_style zero 6.0\npair_coeff * *",
    "neutral": "pair_style lj/cut 6.0\npair_coeff * * 0.005 2.0",
    "charged": "pair_style lj/cut/coul/cut 6.0\npair_coeff * * 0.005 2.0",
}


@dataclass(frozen=True)
class Scene:
    """One scene, with a given number of values, so that instructions do not depend on the motion.

    ``words``: keywords of the fix; ``before``, ``after``: lines around it;
    ``columns``: columns of the output besides the step; ``each``: output in every step, not only at the end;
    ``crossing``: bodies cross the boundaries of the box.
    """

    shape: str = "triangle"
    forces: str = "none"
    words: str = ""
    boundary: str = "f f f"
    style: str = "full"
    before: str = ""
    after: str = ""
    columns: str = ""
    each: bool = False
    crossing: bool = False

    def deck(self, side, steps):
        """Script with side^3 bodies; its first run has the start, its second run ``steps`` steps."""
        values = DEFAULT_VALUES["first" if "formulation first" in self.words else "momentum"]
        return _DECK.format(
            scene=self,
            method="" if "values" in self.words or "tolerance" in self.words else f"values {values}",
            spacing=SPACING,
            side=side,
            origin=0.0 if self.crossing else 0.4,
            forces=_FORCES[self.forces],
            every=1 if self.each else steps,
            steps=steps,
        )


def write_molecules(folder):
    """Templates that the decks read."""
    for shape, sites in SHAPES.items():
        sections = {
            "Coords": [f"{x} {y} {z}" for x, y, z in sites],
            "Types": [1] * len(sites),
            "Charges": CHARGES[len(sites)],
        }
        lines = [f"{shape} body", "", f"{len(sites)} atoms"]
        for name, values in sections.items():
            lines += ["", name, "", *(f"{k} {value}" for k, value in enumerate(values, 1))]
        (folder / f"molecule.{shape}").write_text("\n".join([*lines, ""]), encoding="utf-8")
