"""The film of test case 3: the body goes round a sphere of the cage, and leaves."""

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image
from tqdm import tqdm

from .figures import LOOK, NOTE, add_body, add_cage
from .view import Camera, Stage

SIZE, DPI = (6.4, 3.6), 100
COLORS, SECONDS = 96, 0.07
VIEW = Camera((92.0, -10.0, 2.0), -72.0, 16.0, 440.0)
CLOSE = 14.0


def _still(scene, k):
    """One picture, (height, width, 3) of bytes."""
    figure = plt.figure(figsize=SIZE, dpi=DPI, facecolor="white")
    axis = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    stage = Stage(VIEW, haze=(30.0, 190.0))
    add_cage(stage, 0.8)
    if k > 0:
        stage.lines(scene.center[: k + 1], "#009e73", 1.3, 1 + k // 16)
    add_body(stage, scene.sites[k], 1.8)
    height = 76.0
    stage.draw(axis, height * SIZE[0] / SIZE[1], height)
    near = Stage(Camera((0.0, 0.0, 0.0), VIEW.azimuth, VIEW.elevation, 200.0))
    add_body(near, scene.sites[k] - scene.center[k], 5.0)
    inset = figure.add_axes((0.76, 0.55, 0.23, 0.37))
    near.draw(inset, CLOSE + 1.0, CLOSE)
    figure.text(0.02, 0.93, f"t = {scene.time[k]:4.0f}", fontsize=12, family="monospace")
    figure.text(0.875, 0.93, "the body", fontsize=9, ha="center", color="#444444")
    figure.text(0.02, 0.03, NOTE, fontsize=7, color="#888888")
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
    plt.close(figure)
    return pixels


def draw_film(path, scene, begin=200.0, every=4):
    """Film of a Scene from time ``begin`` on as an animated GIF, a picture for each ``every`` samples.

    One palette serves all pictures, so that only what has moved is stored anew.
    """
    rows = range(int(np.searchsorted(scene.time, begin)), len(scene.time), every)
    with plt.rc_context(LOOK):
        bar = tqdm(rows, desc="drawing the film", disable=None)
        stills = [Image.fromarray(_still(scene, k)) for k in bar]
    sample = np.concatenate([np.asarray(stills[k]) for k in (0, len(stills) // 2, -1)])
    palette = Image.fromarray(sample).quantize(COLORS, dither=Image.Dither.NONE)
    frames = [still.quantize(palette=palette, dither=Image.Dither.NONE) for still in stills]
    durations = [int(1000 * SECONDS)] * (len(frames) - 1) + [2000]
    frames[0].save(
        path, save_all=True, append_images=frames[1:], duration=durations, loop=0, optimize=False
    )
