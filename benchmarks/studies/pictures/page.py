"""The pictures in a checkout: doc/pictures, doc/pictures.md."""

from benchmarks.engine.checkout import find, write_page

COMMAND = "benchmarks/run pictures --publish"
PICTURES = {
    "leaving.gif": "Test case 3: the body circles a sphere of the cage, and leaves.",
    "orbit.png": "Test case 1: the path of the centre of mass, in the cage and close by.",
    "tumbling.png": "Test case 1: the body, its angular velocity, and where its long axis points.",
    "energy.png": "Test case 1: energies, and how far the total is from its start.",
}
HOW = """Both runs are those of `examples/case1` and `examples/case3` with the defaults of `fix gear/quat`. Poses
come from dumps by `lammps_gearquat.analysis` ([how to](analysis.md)); charges of the cage are reconstructed.
`benchmarks/run pictures` makes all of them anew."""


def publish(folder, out):
    """Write it all.  ``folder``: the checkout; ``out``: where the pictures are."""
    folder = find(folder)
    lines = ["# Pictures for a talk", "", f"Written by `{COMMAND}`; do not edit.", "", HOW]
    for name, text in PICTURES.items():
        lines += ["", f"![{text}](pictures/{name})", "", f"*{text}*"]
    write_page(folder, "pictures", "\n".join(lines) + "\n", [out / name for name in PICTURES])
