"""Numbers of other libraries for tests/conventions.rs.

    pip install numpy scipy sphericart
    python conventions.py > conventions.txt

Made with numpy 2.4.6, scipy 1.17.1, sphericart 2.0.4. A line is a name and its numbers.

Where a library cannot be called from here its published formulas are written out:
- 3D Gaussian splatting (graphdeco-inria/gaussian-splatting): the polynomials and constants SH_C0..SH_C3 of `eval_sh` in
  utils/sh_utils.py; `eval_sh(...) + 0.5` in gaussian_renderer/__init__.py; f_rest reshaped to (P, 3, n²−1) when a PLY file is
  read, and kept transposed, in scene/gaussian_model.py.
- filament (google/filament): the factors A and moments of `computeIrradianceSH3Bands` in libs/ibl/src/CubemapSH.cpp, and the
  sum `Irradiance_SphericalHarmonics` in shaders/src/surface_light_indirect.fs.
"""

import numpy as np
import sphericart
from scipy.special import sph_harm_y

N = 5
rng = np.random.default_rng(3)


def put(name, values):
    print(name, *(repr(float(v)) for v in np.asarray(values).ravel()))


directions = rng.normal(size=(8, 3))
directions /= np.linalg.norm(directions, axis=1, keepdims=True)
directions = np.concatenate([directions, [[0, 0, 1], [0, 0, -1], [1, 0, 0], [0, -1, 0]]])
put("directions", directions)

# sphericart: values of its basis.
put("sphericart", sphericart.SphericalHarmonics(N - 1).compute(directions))


# SciPy: the complex basis, and the value of an expansion with complex coefficients of a real function.
def scipy_basis(d):
    theta, phi = np.arccos(np.clip(d[:, 2], -1, 1)), np.arctan2(d[:, 1], d[:, 0])
    return np.stack([sph_harm_y(l, m, theta, phi) for l in range(N) for m in range(-l, l + 1)], axis=1)


basis = scipy_basis(directions)
put("scipy", np.stack([basis.real, basis.imag], axis=-1))
complex_coeffs = rng.normal(size=N * N) + 1j * rng.normal(size=N * N)
put("complex", np.stack([complex_coeffs.real, complex_coeffs.imag], axis=-1))
put("complex_value", (basis @ complex_coeffs).real)

# 3D Gaussian splatting.
C0 = 0.28209479177387814
C1 = 0.4886025119029199
C2 = [1.0925484305920792, -1.0925484305920792, 0.31539156525252005, -1.0925484305920792, 0.5462742152960396]
C3 = [
    -0.5900435899266435, 2.890611442640554, -0.4570457994644658, 0.3731763325901154,
    -0.4570457994644658, 1.445305721320277, -0.5900435899266435,
]  # fmt: skip
x, y, z = directions.T
polynomials = np.stack(
    [
        C0 + 0 * x,
        -C1 * y,
        C1 * z,
        -C1 * x,
        C2[0] * x * y,
        C2[1] * y * z,
        C2[2] * (2 * z * z - x * x - y * y),
        C2[3] * x * z,
        C2[4] * (x * x - y * y),
        C3[0] * y * (3 * x * x - y * y),
        C3[1] * x * y * z,
        C3[2] * y * (4 * z * z - x * x - y * y),
        C3[3] * z * (2 * z * z - 3 * x * x - 3 * y * y),
        C3[4] * x * (4 * z * z - x * x - y * y),
        C3[5] * z * (x * x - y * y),
        C3[6] * x * (x * x - 3 * y * y),
    ],
    axis=1,
)
f_dc = rng.normal(size=3)
f_rest = rng.normal(size=45)  # as in a PLY file
features = np.concatenate([f_dc[None, :], f_rest.reshape(3, 15).T])  # (16, 3), as in memory
put("splat_dc", f_dc)
put("splat_rest", f_rest)
put("splat_features_rest", features[1:])
put("splat_colour", polynomials @ features + 0.5)

# A sphere of quadrature points, exact for polynomials to degree 40.
nodes, weights = np.polynomial.legendre.leggauss(21)
longitudes = 2 * np.pi * (np.arange(41) + 0.5) / 41
Z, PHI = (a.ravel() for a in np.meshgrid(nodes, longitudes, indexing="ij"))
W = np.repeat(weights, 41) * 2 * np.pi / 41
S = np.stack([np.sqrt(1 - Z * Z) * np.cos(PHI), np.sqrt(1 - Z * Z) * np.sin(PHI), Z], axis=1)


# filament: its nine colours for the radiance (1 + x + 2y + 3xz, 2 − z + xy, 3 + y² + z⁴), and its shader's sum.
def radiance(s):
    x, y, z = s.T
    return np.stack([1 + x + 2 * y + 3 * x * z, 2 - z + x * y, 3 + y * y + z**4], axis=1)


def shader_terms(s):
    x, y, z = s.T
    return np.stack([1 + 0 * x, y, z, x, y * x, y * z, 3 * z * z - 1, z * x, x * x - y * y], axis=1)


c = [np.pi, 2 * np.pi / 3, np.pi / 4]
quarter, sixteenth = 1 / (4 * np.pi**2), 1 / (16 * np.pi**2)
A = np.array(
    [quarter * c[0]] + [quarter * 3 * c[1]] * 3
    + [quarter * 15 * c[2], quarter * 15 * c[2], sixteenth * 5 * c[2], quarter * 15 * c[2], sixteenth * 15 * c[2]]
)  # fmt: skip
filament = A[:, None] * (shader_terms(S).T @ (W[:, None] * radiance(S)))
put("filament", filament)
put("filament_shaded", shader_terms(directions) @ filament)


# A frame with y up: the same function, projected by SciPy's harmonics, seen in both frames.
def real_basis(d):
    b = scipy_basis(d)
    out = np.empty(b.shape)
    for l in range(N):
        for m in range(-l, l + 1):
            i = l * (l + 1) + m
            out[:, i] = b[:, i].real if m == 0 else np.sqrt(2) * (b[:, i].real if m > 0 else b[:, i - 2 * m].imag)
    return out


def seen(s):
    x, y, z = s.T
    return 1 + y + x * y * z - 2 * y**4 + z**3 * x


up_is_y = real_basis(S).T @ (W * seen(S))
# What is at (x, −z, y) with z up is at (x, y, z) with y up, so the function there is `seen` at (x, z', −y').
up_is_z = real_basis(S).T @ (W * seen(np.stack([S[:, 0], S[:, 2], -S[:, 1]], axis=1)))
put("y_up", up_is_y)
put("z_up", up_is_z)
