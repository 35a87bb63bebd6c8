"""The scenes of the references: procedural meshes of ours, PLY writing, and reading of one outside mesh.

Every vertex is placed where visibility is well defined: no vertex lies in a crease between two surfaces. Blocks hover
GAP above the floor (a twentieth of a pixel) and the lines of the floor's grid pass walls at a distance of GAP,
so the value at a vertex does not depend on how a ray tracer treats a ray that starts inside a wall.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

# Distance between a block and the floor, and between a wall and the nearest grid lines, in scene units.
GAP = 0.002


@dataclass
class Mesh:
    """Triangles with shading normals and linear albedo per vertex; counter-clockwise seen from outside."""

    positions: np.ndarray  # [V, 3] float64, rounded to float32 values
    normals: np.ndarray  # [V, 3] unit
    albedo: np.ndarray  # [V, 3] linear, constant on each object
    faces: np.ndarray  # [T, 3] integers

    def __post_init__(self):
        self.positions = np.asarray(self.positions, np.float32).astype(np.float64)
        self.normals = np.asarray(self.normals, np.float32).astype(np.float64)
        self.albedo = np.broadcast_to(np.asarray(self.albedo, np.float32), self.positions.shape).astype(np.float64)
        self.faces = np.asarray(self.faces, np.int64)


def join(parts):
    """One mesh out of several objects that share no vertex."""
    starts = np.cumsum([0] + [len(p.positions) for p in parts])
    return Mesh(
        np.concatenate([p.positions for p in parts]),
        np.concatenate([p.normals for p in parts]),
        np.concatenate([p.albedo for p in parts]),
        np.concatenate([p.faces + s for p, s in zip(parts, starts)]),
    )


def grid_faces(rows, columns, wrap=False):
    """Two triangles per cell of a grid of vertices numbered row by row; `wrap` joins the last column to the first."""
    cells = columns if wrap else columns - 1
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(cells), indexing="ij")
    a = (i * columns + j).ravel()
    b = (i * columns + (j + 1) % columns).ravel()
    c, d = a + columns, b + columns
    return np.concatenate([np.stack([a, c, d], 1), np.stack([a, d, b], 1)])


def orient(mesh):
    """Turns faces whose winding opposes the vertex normals."""
    p, n, f = mesh.positions, mesh.normals, mesh.faces
    face = np.cross(p[f[:, 1]] - p[f[:, 0]], p[f[:, 2]] - p[f[:, 0]])
    flip = np.einsum("ij,ij->i", face, n[f].sum(1)) < 0
    mesh.faces[flip] = mesh.faces[flip][:, ::-1]
    return mesh


def icosphere(level, radius, center, albedo):
    """Sphere: icosahedron whose edges are split `level` times, vertices pushed to the sphere."""
    g = (1 + 5**0.5) / 2
    v = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g)]
    v += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    f = "0 11 5 0 5 1 0 1 7 0 7 10 0 10 11 1 5 9 5 11 4 11 10 2 10 7 6 7 1 8 3 9 4 3 4 2 3 2 6 3 6 8 3 8 9 4 9 5 2 4 11 6 2 10 8 6 7 9 8 1"
    v = np.array(v, float)
    f = np.array(f.split(), int).reshape(-1, 3)
    for _ in range(level):
        v, f = split_edges(v, f)
        v /= np.linalg.norm(v, axis=1, keepdims=True)
    v /= np.linalg.norm(v, axis=1, keepdims=True)
    return Mesh(v * radius + np.asarray(center, float), v, albedo, f)


def split_edges(values, faces):
    """One step of midpoint subdivision of `values` [V, k]: each triangle becomes four, no smoothing.

    The new vertices follow the old ones, one for each edge, in the order of first appearance over the edges
    (a,b), (b,c), (c,a) of each face. Face (a,b,c) becomes (a,ab,ca), (b,bc,ab), (c,ca,bc), (ab,bc,ca).
    """
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, first, inverse = np.unique(edges, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    unique = unique[order]
    mid = (rank[inverse.ravel()] + len(values)).reshape(-1, 3)
    ab, bc, ca = mid.T
    a, b, c = faces.T
    four = np.stack([a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca], axis=1).reshape(-1, 3)
    middle = 0.5 * (values[unique[:, 0]] + values[unique[:, 1]])
    return np.concatenate([values, middle]), four


def disk_floor(radii, segments, albedo):
    """Disk in the plane y = 0, facing up: a centre and rings of `segments` vertices at the `radii`."""
    phi = 2 * np.pi * np.arange(segments) / segments
    ring = np.stack([np.cos(phi), 0 * phi, np.sin(phi)], axis=1)
    p = np.concatenate([[[0, 0, 0]], (np.asarray(radii)[:, None, None] * ring).reshape(-1, 3)])
    fan = np.stack([np.zeros(segments, int), 1 + np.arange(segments), 1 + (np.arange(segments) + 1) % segments], 1)
    f = np.concatenate([fan, 1 + grid_faces(len(radii), segments, wrap=True)])
    return orient(Mesh(p, np.tile([0.0, 1, 0], (len(p), 1)), albedo, f))


def graded(breaks, refined, first, growth, largest):
    """Grid lines from the first to the last of `breaks`.

    The spacing is `first + growth * distance` to the nearest value in `refined`, at most `largest`.
    """
    lines = []
    for lo, hi in zip(breaks[:-1], breaks[1:]):
        x = np.linspace(lo, hi, 4001)
        distance = np.abs(x[:, None] - np.asarray(refined)[None]).min(1) if len(refined) else np.full_like(x, np.inf)
        density = 1 / np.minimum(largest, first + growth * distance)
        steps = np.concatenate([[0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(x))])
        count = max(1, round(steps[-1]))
        lines.append(np.interp(np.linspace(0, steps[-1], count + 1), steps, x))
    return np.unique(np.concatenate(lines))


def patch(origin, u, v, lines_u, lines_v, normal, albedo):
    """Flat rectangle `origin + a u + b v` over a tensor grid of lines."""
    a, b = np.meshgrid(lines_u, lines_v, indexing="ij")
    p = np.asarray(origin) + a.reshape(-1, 1) * np.asarray(u) + b.reshape(-1, 1) * np.asarray(v)
    n = np.tile(np.asarray(normal, float), (len(p), 1))
    return orient(Mesh(p, n, albedo, grid_faces(len(lines_u), len(lines_v))))


def block(lo, hi, albedo, across, foot, growth, largest):
    """Box over the floor without its bottom, hard edges (each face has its own vertices).

    `across`: lines over the unit interval for horizontal directions; vertical spacing starts at `foot` at the floor.
    """
    (x0, z0), (x1, z1) = lo[::2], hi[::2]
    base, top = lo[1], hi[1]
    up = graded([base, top], [base], foot, growth, largest) - base
    dx, dz = across * (x1 - x0), across * (z1 - z0)
    ex, ey, ez = np.eye(3)
    return [
        patch((x0, top, z0), ex, ez, dx, dz, ey, albedo),
        patch((x1, base, z0), ez, ey, dz, up, ex, albedo),
        patch((x0, base, z0), ez, ey, dz, up, -ex, albedo),
        patch((x0, base, z1), ex, ey, dx, up, ez, albedo),
        patch((x0, base, z0), ex, ey, dx, up, -ez, albedo),
    ]


def lathe(profile, normals, segments, albedo):
    """Surface of revolution about y of a profile [k, 2] of (radius, y); a radius of 0 at either end is one vertex."""
    phi = 2 * np.pi * np.arange(segments) / segments
    c, s = np.cos(phi), np.sin(phi)

    def turn(rows):
        r, y = rows[:, :1], rows[:, 1:]
        return np.stack([r * c, y + 0 * c, r * s], axis=2).reshape(-1, 3)

    inner = profile[1:-1]
    p = np.concatenate([[[0, profile[0, 1], 0]], turn(inner), [[0, profile[-1, 1], 0]]])
    n = np.concatenate([[[0, normals[0, 1], 0]], turn(normals[1:-1]), [[0, normals[-1, 1], 0]]])
    j = np.arange(segments)
    k = (j + 1) % segments
    last = len(p) - 1
    row = last - segments
    fans = [np.stack([0 * j, 1 + j, 1 + k], 1), np.stack([0 * j + last, row + j, row + k], 1)]
    return orient(Mesh(p, n, albedo, np.concatenate(fans + [1 + grid_faces(len(inner), segments, wrap=True)])))


def sphere_on_plane():
    """A sphere of radius 1 hovering 0.15 above a disk."""
    radii = graded([0, 4.2], [0.0], 0.06, 0.028, 0.16)[1:]
    return join([disk_floor(radii, 72, (0.75, 0.7, 0.65)), icosphere(4, 1.0, (0, 1.15, 0), (0.35, 0.55, 0.8))])


def pillar():
    """A red pillar and a low green step on a pale floor."""
    walls = {"x": [-0.95, -0.35, 0.25, 1.45], "z": [-0.55, 0.05, -0.15, 0.85]}
    lines = {}
    for axis, at in walls.items():
        sides = sorted(w + s * GAP for w in at for s in (-1, 1))
        lines[axis] = graded([-2.6] + sides + [2.6], at, 0.025, 0.22, 0.22)
    floor = patch((0, 0, 0), (1, 0, 0), (0, 0, 1), lines["x"], lines["z"], (0, 1, 0), (0.75, 0.75, 0.72))
    tall = block((-0.95, GAP, -0.55), (-0.35, 1.7, 0.05), (0.8, 0.2, 0.15), np.linspace(0, 1, 9), 0.02, 0.16, 0.12)
    low = block((0.25, GAP, -0.15), (1.45, 0.4, 0.85), (0.2, 0.65, 0.25), np.linspace(0, 1, 15), 0.02, 0.16, 0.08)
    return join([floor, *tall, *low])


def bowl():
    """A thick orange bowl, open above, and a pale ball hovering inside: strong interreflection, no hard edge."""
    inner, thick = 1.0, 0.12
    a = np.linspace(0, np.pi / 2, 31)  # from the bottom of the inside up to the rim
    inside = np.stack([np.sin(a), -np.cos(a)], 1)
    t = np.linspace(0, np.pi, 9)[1:-1]  # over the rim, a half circle
    rim = np.stack([-np.cos(t), np.sin(t)], 1)
    o = np.linspace(np.pi / 2, 0, 21)
    outside = np.stack([np.sin(o), -np.cos(o)], 1)
    profile = np.concatenate([
        inner * inside,
        [inner + thick / 2, 0] + thick / 2 * rim,
        (inner + thick) * outside,
    ])
    normals = np.concatenate([-inside, rim, outside])
    profile[[0, -1], 0] = 0
    shell = lathe(profile, normals, 80, (0.8, 0.42, 0.2))
    return join([shell, icosphere(4, 0.38, (0.22, -0.42, 0.05), (0.6, 0.75, 0.7))])


def read_obj(path):
    """Positions and triangles of an OBJ file that has only triangles; anything else in it is ignored."""
    positions, faces = [], []
    with open(path, encoding="ascii") as lines:
        for line in lines:
            word, *rest = line.split() or [""]
            if word == "v":
                positions.append([float(x) for x in rest[:3]])
            elif word == "f":
                assert len(rest) == 3, f"{path}: a face with {len(rest)} corners; only triangles are read"
                faces.append([int(corner.split("/")[0]) - 1 for corner in rest])
    return np.array(positions), np.array(faces)


def outside_mesh(path, subdivisions, albedo):
    """A mesh of ../shared/data, welded, with smooth normals, then split `subdivisions` times.

    1. Positions are rounded to f32; vertices with equal positions are one vertex.
    2. The normal of a vertex is the normalised sum of the cross products (b-a)x(c-a) of its faces (area weights).
    3. Each step of `split_edges`: a midpoint for position and normal, the normal normalised again.
    """
    positions, faces = read_obj(path)
    positions, inverse = np.unique(positions.astype(np.float32), axis=0, return_inverse=True)
    positions, faces = positions.astype(np.float64), inverse.ravel()[faces]
    a, b, c = (positions[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    normals = np.zeros_like(positions)
    for k in range(3):
        np.add.at(normals, faces[:, k], cross)
    values = np.concatenate([positions, normalized(normals)], axis=1)
    for _ in range(subdivisions):
        values, faces = split_edges(values, faces)
        values[:, 3:] = normalized(values[:, 3:])
    return Mesh(values[:, :3], values[:, 3:], albedo, faces)


def normalized(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def write_ply(mesh, path):
    """Binary little-endian PLY: position, normal, linear albedo as float, triangles with 16-bit indices."""
    assert len(mesh.positions) <= 65536
    header = ["ply", "format binary_little_endian 1.0", "comment albedo is linear; made by tests/references/make.py"]
    header += [f"element vertex {len(mesh.positions)}"] + [f"property float {name}" for name in PLY_VERTEX]
    header += [f"element face {len(mesh.faces)}", "property list uchar ushort vertex_indices", "end_header", ""]
    rows = np.concatenate([mesh.positions, mesh.normals, mesh.albedo], axis=1).astype("<f4")
    faces = np.empty(len(mesh.faces), PLY_FACE)
    faces["n"], faces["v"] = 3, mesh.faces
    with open(path, "wb") as file:
        file.write("\n".join(header).encode() + rows.tobytes() + faces.tobytes())


def read_ply(path):
    """Reads what `write_ply` writes, and nothing else."""
    data = Path(path).read_bytes()
    start = data.index(b"end_header\n") + len(b"end_header\n")
    counts = [int(line.split()[2]) for line in data[:start].decode().splitlines() if line.startswith("element")]
    rows = np.frombuffer(data, "<f4", counts[0] * len(PLY_VERTEX), start).reshape(counts[0], -1)
    faces = np.frombuffer(data, PLY_FACE, counts[1], start + rows.nbytes)
    return Mesh(rows[:, :3], rows[:, 3:6], rows[:, 6:], faces["v"])


PLY_VERTEX = ["x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"]
PLY_FACE = np.dtype([("n", "u1"), ("v", "<u2", 3)])
SCENES = {"sphere_on_plane": sphere_on_plane, "pillar": pillar, "bowl": bowl}
