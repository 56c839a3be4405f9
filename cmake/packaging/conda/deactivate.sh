# Sourced when the environment is deactivated: takes one @FOLDER@ out of LAMMPS_PLUGIN_PATH, wherever it stands.
case ":${LAMMPS_PLUGIN_PATH-}:" in
  *":@FOLDER@:"*)
    LAMMPS_PLUGIN_PATH=":$LAMMPS_PLUGIN_PATH:"
    LAMMPS_PLUGIN_PATH=${LAMMPS_PLUGIN_PATH%%":@FOLDER@:"*}:${LAMMPS_PLUGIN_PATH#*":@FOLDER@:"}
    LAMMPS_PLUGIN_PATH=${LAMMPS_PLUGIN_PATH#:}
    LAMMPS_PLUGIN_PATH=${LAMMPS_PLUGIN_PATH%:}
    [ -n "$LAMMPS_PLUGIN_PATH" ] || unset LAMMPS_PLUGIN_PATH
    ;;
esac
