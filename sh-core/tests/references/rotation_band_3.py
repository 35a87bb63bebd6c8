"""Seven directions at which the functions of band 3 are as independent as can be, and the inverse of their values.

    pip install numpy==2.4.6 scipy==1.17.1
    python rotation_band_3.py

Prints the tables of src/rotation/values.rs. The condition of the matrix is 1.75.
"""

import numpy as np
from scipy.optimize import minimize


def basis(d):
    x, y, z = d.T
    a, b = np.sqrt(35 / (32 * np.pi)), np.sqrt(105 / (4 * np.pi))
    c, e = np.sqrt(21 / (32 * np.pi)), np.sqrt(7 / (16 * np.pi))
    xx, yy, zz = x * x, y * y, z * z
    columns = [
        -a * y * (3 * xx - yy),
        b * x * y * z,
        -c * y * (4 * zz - xx - yy),
        e * z * (2 * zz - 3 * xx - 3 * yy),
        -c * x * (4 * zz - xx - yy),
        b / 2 * z * (xx - yy),
        -a * x * (xx - 3 * yy),
    ]
    return np.stack(columns, axis=1)


def unit(parameters):
    d = parameters.reshape(7, 3)
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def objective(parameters):
    return np.sum(1 / np.linalg.svd(basis(unit(parameters)), compute_uv=False) ** 2)


rng = np.random.default_rng(0)
best = min((minimize(objective, rng.normal(size=21), method="BFGS") for _ in range(60)), key=lambda r: r.fun)
directions = unit(best.x)
inverse = np.linalg.inv(basis(directions))


def rows(name, table):
    print(f"const {name}: [[f64; 8]; {len(table)}] = [")
    for row in table:
        print("    [" + ", ".join(repr(float(v)) for v in row) + ", 0.0],")
    print("];")


rows("DIRECTIONS", directions.T)
rows("INVERSE", inverse.T)
