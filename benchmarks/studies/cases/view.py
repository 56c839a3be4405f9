"""A camera, and shaded spheres and rods drawn from far to near on the axes of a figure."""

from dataclasses import dataclass, field

import numpy as np
from matplotlib.colors import to_rgb

WHITE = np.ones(3)


@dataclass(frozen=True)
class Camera:
    """Perspective view of ``target`` (3,) from ``distance``; angles in degrees, z is up."""

    target: tuple
    azimuth: float
    elevation: float
    distance: float

    def frame(self):
        """Right, up and towards the viewer, as rows (3, 3)."""
        a, e = np.radians([self.azimuth, self.elevation])
        back = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        return np.array([right, np.cross(back, right), back])

    def project(self, points):
        """Points (..., 3) on the picture (..., 2), their depth (...), and the size of a unit there (...)."""
        seen = (np.asarray(points, dtype=float) - self.target) @ self.frame().T
        scale = self.distance / (self.distance - seen[..., 2])
        return seen[..., :2] * scale[..., None], seen[..., 2], scale


def sphere_image(color, fade=0.0, pixels=96):
    """A lit sphere as an image (pixels, pixels, 4); ``fade`` mixes it with white, 1 is white."""
    edge = (np.arange(pixels) + 0.5) / pixels * 2.0 - 1.0
    x, y = np.meshgrid(edge, edge)
    r2 = x * x + y * y
    z = np.sqrt(np.clip(1.0 - r2, 0.0, 1.0))
    light = np.array([-0.45, 0.55, 0.71])
    bright = np.clip(light[0] * x + light[1] * y + light[2] * z, 0.0, 1.0)
    shade = (0.45 + 0.55 * bright)[..., None] * np.array(to_rgb(color))
    shade = shade + 0.5 * (bright**24)[..., None] * (WHITE - shade)
    image = np.empty((pixels, pixels, 4))
    image[..., :3] = np.clip(shade + fade * (WHITE - shade), 0.0, 1.0)
    image[..., 3] = np.clip((1.0 - np.sqrt(r2)) * pixels / 2.0, 0.0, 1.0)
    return image


@dataclass
class Stage:
    """All objects in view of a camera: collected, then drawn from far to near."""

    camera: Camera
    haze: tuple = (1e9, 2e9)  # depths behind the target between which objects fade
    _things: list = field(default_factory=list)

    def _fade(self, depth):
        near, far = self.haze
        return 0.75 * float(np.clip((-depth - near) / (far - near), 0.0, 1.0))

    def spheres(self, centers, radius, color):
        """Spheres at centers (n, 3)."""
        for at, depth, scale in zip(*self.camera.project(np.atleast_2d(centers))):
            self._things.append((depth, self._draw_sphere, (at, radius * scale, color, depth)))

    def lines(self, points, color, width, pieces=1, alpha=1.0):
        """A path (n, 3), cut into pieces that are sorted by depth; ``color``: one for all, or one for each piece."""
        at, depth, _ = self.camera.project(points)
        colors = [color] * pieces if isinstance(color, str) else color
        for part, own in zip(np.array_split(np.arange(len(points) - 1), pieces), colors):
            if len(part):
                chosen = np.append(part, part[-1] + 1)
                middle = depth[chosen].mean()
                mixed = np.array(to_rgb(own)) + self._fade(middle) * (WHITE - to_rgb(own))
                self._things.append(
                    (middle, self._draw_line, (at[chosen], tuple(mixed), width, alpha))
                )

    def rod(self, begin, end, color, width, radii=(0.0, 0.0)):
        """A straight rod between the surfaces of two spheres, in pieces that are sorted by depth."""
        begin, along = np.asarray(begin), np.asarray(end) - np.asarray(begin)
        inside = 0.97 * np.asarray(radii) / np.linalg.norm(along)
        steps = np.linspace(inside[0], 1.0 - inside[1], 5)[:, None]
        self.lines(begin + steps * along, color, width, 4)

    def _draw_sphere(self, axis, order, at, radius, color, depth):
        extent = (at[0] - radius, at[0] + radius, at[1] - radius, at[1] + radius)
        image = sphere_image(color, self._fade(depth))
        axis.imshow(image, extent=extent, origin="lower", zorder=order, interpolation="bilinear")

    @staticmethod
    def _draw_line(axis, order, at, color, width, alpha):
        axis.plot(
            *at.T, color=color, linewidth=width, alpha=alpha, zorder=order, solid_capstyle="round"
        )

    def draw(self, axis, half_width, half_height):
        """Draw everything on ``axis``, with limits at these distances from the target."""
        for order, (_, draw, what) in enumerate(sorted(self._things, key=lambda t: t[0])):
            draw(axis, 2.0 + order, *what)
        axis.set(xlim=(-half_width, half_width), ylim=(-half_height, half_height), aspect="equal")
        axis.set_axis_off()
