# Sourced when the environment is activated. The recipe puts the folder of the plugin in place of @FOLDER@.
export LAMMPS_PLUGIN_PATH="@FOLDER@${LAMMPS_PLUGIN_PATH:+:$LAMMPS_PLUGIN_PATH}"
