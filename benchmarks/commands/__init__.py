"""The commands of studies that do not use the engine yet."""

from .bench import bench
from .cases import cases
from .drift import drift
from .effects import effects
from .isokinetic import isokinetic
from .pictures import pictures
from .workprecision import workprecision

COMMANDS = {
    command.name: command
    for command in (bench, cases, drift, effects, isokinetic, pictures, workprecision)
}
