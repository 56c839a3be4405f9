"""What all studies share: running LAMMPS, reading what it wrote, writing pages."""
