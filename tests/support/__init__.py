"""What several tests need: how LAMMPS runs, scenes, made-up data, texts of pages."""
