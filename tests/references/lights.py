"""Lights whose radiance is a non-negative spherical-harmonic expansion of low order, known exactly.

    L(s) = floor + sum_k color_k ((1 + axis_k . s) / 2)^(n-1)

is a polynomial of degree n-1 in s, so its expansion of order n is exact: it has no light above band n-1.
Convention of the library: real, orthonormal, Condon-Shortley phase, index l(l+1)+m, polar axis +z.
"""

import math

import numpy as np


def sh_basis(order, s):
    """Values of the n^2 basis functions in the unit directions `s` [N, 3]: [N, n^2].

    Legendre functions with Condon-Shortley phase, divided by sin^m so that cos/sin(m phi) sin^m are polynomials in x, y.
    """
    x, y, z = np.asarray(s, float).T
    out = np.empty((len(x), order * order))
    power = np.ones_like(x) + 0j  # (x + iy)^m
    pmm = np.ones_like(x)  # P_m^m / sin^m = (-1)^m (2m-1)!!
    for m in range(order):
        below, here = np.zeros_like(x), pmm
        for l in range(m, order):
            k = math.sqrt((2 * l + 1) / (4 * math.pi) * math.factorial(l - m) / math.factorial(l + m))
            i = l * (l + 1)
            if m == 0:
                out[:, i] = k * here
            else:
                out[:, i + m] = math.sqrt(2) * k * here * power.real
                out[:, i - m] = math.sqrt(2) * k * here * power.imag
            below, here = here, ((2 * l + 1) * z * here - (l + m) * below) / (l - m + 1)
        power = power * (x + 1j * y)
        pmm = -(2 * m + 1) * pmm
    return out


def sphere_quadrature(degree):
    """Points and weights that integrate polynomials up to `degree` over the sphere exactly (Gauss-Legendre x trapezoid)."""
    z, w = np.polynomial.legendre.leggauss(degree // 2 + 1)
    count = degree + 1
    phi = 2 * np.pi * np.arange(count) / count
    r = np.sqrt(1 - z * z)
    s = np.stack([np.outer(r, np.cos(phi)), np.outer(r, np.sin(phi)), np.outer(z, np.ones(count))], axis=2)
    return s.reshape(-1, 3), np.repeat(w * 2 * np.pi / count, count)


class Light:
    def __init__(self, name, order, floor, lobes):
        self.name, self.order = name, order
        self.floor = np.array(floor, float)
        self.axes = np.array([axis for axis, _ in lobes], float)
        self.axes /= np.linalg.norm(self.axes, axis=1, keepdims=True)
        self.colors = np.array([color for _, color in lobes], float)

    def radiance(self, s):
        """Closed form, [N, 3] for unit directions [N, 3]."""
        return self.floor + (0.5 + 0.5 * np.asarray(s) @ self.axes.T) ** (self.order - 1) @ self.colors

    def coefficients(self):
        """The light vector [3, n^2], by a quadrature that is exact for the product of light and basis."""
        s, w = sphere_quadrature(2 * (self.order - 1))
        return (sh_basis(self.order, s).T @ (w[:, None] * self.radiance(s))).T

    def record(self):
        """What lights.json holds; refuses to write coefficients that are not exact."""
        light = self.coefficients()
        s = random_directions(4096, seed=7)
        error = np.abs(sh_basis(self.order, s) @ light.T - self.radiance(s)).max()
        assert error < 1e-12, f"{self.name}: the expansion is off by {error}"
        some = s[:6]
        return {
            "name": self.name,
            "order": self.order,
            "form": "floor + sum of color * ((1 + axis . s) / 2)^(order - 1)",
            "floor": self.floor.tolist(),
            "lobes": [{"axis": a.tolist(), "color": c.tolist()} for a, c in zip(self.axes, self.colors)],
            "light": light.tolist(),
            "checks": [{"direction": d.tolist(), "radiance": r.tolist()} for d, r in zip(some, self.radiance(some))],
        }


def random_directions(count, seed):
    v = np.random.default_rng(seed).normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def map_directions(width, height):
    """Directions of the samples of a Mitsuba `envmap`: u = (column + 0.5) / width, v = row / (height - 1), y up.

    u = atan2(x, -z) / 2pi and v = acos(y) / pi; rows 0 and height-1 are the poles. Mitsuba is bilinear between them.
    """
    u = (np.arange(width) + 0.5) / width
    v = np.arange(height) / (height - 1)
    theta, phi = np.pi * v[:, None], 2 * np.pi * u[None]
    y = np.cos(theta) + 0 * phi
    return np.stack([np.sin(theta) * np.sin(phi), y, -np.sin(theta) * np.cos(phi)], axis=2)


def map_of(light, width=1024, height=512):
    """Pixels [height, width, 3] f32 for Mitsuba's `envmap`."""
    s = map_directions(width, height).reshape(-1, 3)
    return light.radiance(s).reshape(height, width, 3).astype(np.float32)


def texel_constant(pixels, factor=8):
    """Samples for Mitsuba's `envmap` that make it constant on each texel of a latitude-longitude map [h, w, 3].

    Texel (x, y) covers u in [x, x+1]/w and v in [y, y+1]/h. Only a band of 1/factor texel between texels is blended.
    """
    h, w, _ = pixels.shape
    columns = ((np.arange(w * factor) + 0.5) / factor).astype(int)
    rows = np.minimum((np.arange(h * factor) / (h * factor - 1) * h).astype(int), h - 1)
    return pixels[rows][:, columns]


def all_lights():
    """A warm key light from the left, a blue sky, an orange light from the right; `soft6` also has light from below."""
    key, sky, side, below = (-0.7, 0.65, 0.45), (0.3, 1, -0.5), (0.9, 0.15, 0.4), (0, -1, 0.3)
    soft = [(key, (4.2, 3.5, 2.6)), (sky, (0.3, 0.6, 1.2)), (side, (0.9, 0.35, 0.15))]
    sharp = [(key, (6.5, 5.4, 4.0)), (sky, (0.5, 1.1, 2.4)), (side, (1.8, 0.7, 0.3)), (below, (0.2, 0.35, 0.25))]
    return [Light("soft4", 4, (0.05, 0.06, 0.08), soft), Light("soft6", 6, (0.03, 0.035, 0.05), sharp)]
