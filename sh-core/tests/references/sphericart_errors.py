"""The errors of PyPI sphericart by order, for the table at the head of tests/accuracy.rs.

    pip install numpy==2.4.6 scipy==1.17.1 sphericart==2.0.4
    python sphericart_errors.py

Truth is scipy.special.sph_harm_y in float64, in sphericart's convention (real, no Condon-Shortley phase).
"""

import numpy as np
import sphericart
from scipy.special import sph_harm_y

THETAS = np.array([1e-3, 1e-2, 0.1, 0.5, 1.0, np.pi / 2, 2.0, 3.1])
PHIS = np.array([0.3, 2.0, 4.0])


def truth(n, theta, phi):
    values = []
    for l in range(n):
        for m in range(-l, l + 1):
            y = sph_harm_y(l, abs(m), theta, phi)
            part = y.imag if m < 0 else y.real
            values.append((-1) ** m * part * (np.sqrt(2) if m else 1))
    return np.stack(values, axis=-1)


theta, phi = (a.ravel() for a in np.meshgrid(THETAS, PHIS))
x = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
for dtype, orders in ((np.float32, (6, 10, 19, 20, 32, 65)), (np.float64, (65, 88, 89, 128, 150))):
    for n in orders:
        s = x.astype(dtype)
        # The direction that was rounded is the one that is evaluated.
        exact = s.astype(np.float64)
        exact /= np.linalg.norm(exact, axis=1, keepdims=True)
        angles = np.arctan2(np.hypot(exact[:, 0], exact[:, 1]), exact[:, 2]), np.arctan2(exact[:, 1], exact[:, 0])
        error = np.abs(sphericart.SphericalHarmonics(n - 1).compute(s) - truth(n, *angles)).max()
        print(f"{dtype.__name__} n = {n}: {error:.1e}")
