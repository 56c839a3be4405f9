"""The commands of studies that do not use the engine yet."""

from .bench import bench
from .cases import cases
from .pictures import pictures
from .workprecision import workprecision

COMMANDS = {
    command.name: command
    for command in (bench, cases, pictures, workprecision)
}
