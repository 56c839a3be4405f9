"""The commands of studies that do not use the engine yet."""

from .bench import bench
from .workprecision import workprecision

COMMANDS = {command.name: command for command in (bench, workprecision)}
